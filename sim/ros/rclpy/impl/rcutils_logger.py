"""``rclpy.impl.rcutils_logger``, as programs import it."""

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
