"""The severities of lines, where rclpy keeps them."""

from sim.ros.logging.logger import LoggingSeverity

__all__ = ["LoggingSeverity"]
