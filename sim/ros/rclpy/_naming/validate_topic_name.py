"""``rclpy.validate_topic_name``, as programs import it."""

from sim.ros.naming.validate_topic_name import *
