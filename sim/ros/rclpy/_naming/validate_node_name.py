"""``rclpy.validate_node_name``, as programs import it."""

from sim.ros.exceptions import InvalidNodeNameException
from sim.ros.naming.validation import validate_node_name
