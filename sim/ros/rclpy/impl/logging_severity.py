"""``rclpy.impl.logging_severity``, as programs import it."""

from sim.ros.logging.logger import LoggingSeverity

__all__ = ["LoggingSeverity"]
