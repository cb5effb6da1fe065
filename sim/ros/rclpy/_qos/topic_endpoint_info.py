"""``rclpy.topic_endpoint_info``, as programs import it."""

from sim.ros.entities.topic_endpoint_info import *
