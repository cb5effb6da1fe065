"""The class of loggers and what holds back their lines, where rclpy keeps them."""

from sim.ros.logging.filters import (
    LoggingFilter,
    Once,
    SkipFirst,
    Throttle,
    get_filters_from_kwargs,
    supported_filters,
)
from sim.ros.logging.logger import RcutilsLogger

__all__ = [
    "LoggingFilter",
    "Once",
    "RcutilsLogger",
    "SkipFirst",
    "Throttle",
    "get_filters_from_kwargs",
    "supported_filters",
]
