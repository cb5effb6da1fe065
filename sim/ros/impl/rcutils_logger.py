"""The class of loggers, where rclpy keeps it."""

from sim.ros.logging import RcutilsLogger

__all__ = ["RcutilsLogger"]
