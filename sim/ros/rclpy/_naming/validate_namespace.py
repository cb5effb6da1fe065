"""``rclpy.validate_namespace``, as programs import it."""

from sim.ros.exceptions import InvalidNamespaceException
from sim.ros.naming.validation import validate_namespace
