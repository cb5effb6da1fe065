"""The severities of lines, where rclpy keeps them."""

from sim.ros.logging import LoggingSeverity

__all__ = ["LoggingSeverity"]
