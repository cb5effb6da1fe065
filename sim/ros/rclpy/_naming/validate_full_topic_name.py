"""``rclpy.validate_full_topic_name``, as programs import it."""

from sim.ros.naming.validate_full_topic_name import *
