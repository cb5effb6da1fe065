"""``rclpy.parameter_client``, as programs import it."""

from sim.ros.node.parameter_client import *
