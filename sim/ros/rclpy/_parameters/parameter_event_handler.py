"""``rclpy.parameter_event_handler``, as programs import it."""

from sim.ros.node.parameter_event_handler import *
