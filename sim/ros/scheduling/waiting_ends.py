"""How an executor's waiting for work can end without any, and how long it may last."""

from __future__ import annotations

from typing import TypeAlias


class ExternalShutdownException(Exception):
    """The context ended while its executor was spinning."""

    __module__ = "rclpy.executors"


class ShutdownException(Exception):
    """The executor was shut down while something waited for its work."""

    __module__ = "rclpy.executors"


class TimeoutException(Exception):
    """Nothing became ready in time."""

    __module__ = "rclpy.executors"


class ConditionReachedException(Exception):
    """The condition that ends the waiting holds."""

    __module__ = "rclpy.executors"


def never() -> bool:
    """The condition that ends no waiting."""
    return False


class TimeoutObject:
    """Seconds that are left of a timeout; changing them does not make it another one."""

    def __init__(self, timeout: float) -> None:
        self.timeout = timeout


Timeout: TypeAlias = "float | TimeoutObject | None"
"""Seconds; None or negative ones stand for ever."""


def seconds_of(timeout: Timeout) -> float | None:
    """What a timeout holds now, in seconds."""
    return timeout.timeout if isinstance(timeout, TimeoutObject) else timeout
