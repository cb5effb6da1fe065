"""The errors that programs import from rclpy's compiled part."""

from sim.ros.exceptions import InvalidHandle, RCLError, RCLInvalidROSArgsError, UnknownROSArgsError

__all__ = ["InvalidHandle", "RCLError", "RCLInvalidROSArgsError", "UnknownROSArgsError"]
