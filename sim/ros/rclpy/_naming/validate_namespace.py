"""``rclpy.validate_namespace``, as programs import it."""

from sim.ros.naming.validate_namespace import *
