"""``rclpy.validate_parameter_name``, as programs import it."""

from sim.ros.naming.validate_parameter_name import *
