"""``rclpy.parameter_service``, as programs import it."""

from sim.ros.node.parameter_service import *
