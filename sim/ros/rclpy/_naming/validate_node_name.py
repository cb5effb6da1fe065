"""``rclpy.validate_node_name``, as programs import it."""

from sim.ros.naming.validate_node_name import *
