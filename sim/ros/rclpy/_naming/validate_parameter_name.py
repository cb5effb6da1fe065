"""``rclpy.validate_parameter_name``, as programs import it."""

from sim.ros.exceptions import InvalidParameterException
from sim.ros.naming.validation import validate_parameter_name
