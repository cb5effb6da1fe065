"""The exceptions that end an executor's wait without work, and timeouts."""

from typing import TypeAlias


class ExternalShutdownException(Exception):
    """The context ended while its executor was spinning."""

    __module__ = "rclpy.executors"


class ShutdownException(Exception):
    """The executor was shut down during the wait."""

    __module__ = "rclpy.executors"


class TimeoutException(Exception):
    """Nothing became ready in time."""

    __module__ = "rclpy.executors"


class ConditionReachedException(Exception):
    """The condition that ends the wait holds."""

    __module__ = "rclpy.executors"


def never() -> bool:
    """The condition that never ends a wait."""
    return False


class TimeoutObject:
    """The remaining seconds of a timeout; a change of the seconds does not start a new wait."""

    def __init__(self, timeout: float) -> None:
        self.timeout = timeout


Timeout: TypeAlias = "float | TimeoutObject | None"
"""Seconds; None or a negative number means for ever."""


def seconds_of(timeout: Timeout) -> float | None:
    """The seconds of a timeout."""
    return timeout.timeout if isinstance(timeout, TimeoutObject) else timeout
