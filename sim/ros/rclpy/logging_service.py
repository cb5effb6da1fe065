"""``rclpy.logging_service``, as programs import it."""

from sim.ros.node.logging_service import *
