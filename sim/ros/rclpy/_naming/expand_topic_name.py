"""``rclpy.expand_topic_name``, as programs import it."""

from sim.ros.naming.expand_topic_name import *
