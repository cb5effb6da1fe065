"""Loggers: lines as ROS prints them, from DEBUG to FATAL."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from enum import IntEnum
from typing import Any

from sim.ros.host import current_host
from sim.trace.events import Severity


class LoggingSeverity(IntEnum):
    """How grave a line is."""

    UNSET = 0
    DEBUG = 10
    INFO = 20
    WARN = 30
    ERROR = 40
    FATAL = 50


_SHOWN = {
    LoggingSeverity.DEBUG: Severity.DEBUG,
    LoggingSeverity.INFO: Severity.INFO,
    LoggingSeverity.WARN: Severity.WARN,
    LoggingSeverity.ERROR: Severity.ERROR,
    LoggingSeverity.FATAL: Severity.FATAL,
}
_levels: dict[str, LoggingSeverity] = {}
_loggers: dict[str, RcutilsLogger] = {}


def line(severity: Severity, stamp: int, logger: str, text: str) -> str:
    """A log line as ROS prints it; ``stamp`` is nanoseconds since 1970."""
    seconds, nanoseconds = divmod(stamp, 1_000_000_000)
    return f"[{severity}] [{seconds}.{nanoseconds:09d}] [{logger}]: {text}"


class _Site:
    """What one place in the program that logs has logged so far."""

    __slots__ = ("last", "skipped", "spoken")

    def __init__(self) -> None:
        self.last: int | None = None
        self.skipped = False
        self.spoken = False


class RcutilsLogger:
    """A named logger. Lines below its level are dropped; without a level of its own, its parent's counts."""

    def __init__(self, name: str = "") -> None:
        self.name = name
        self._sites: dict[tuple[str, int], _Site] = {}

    def get_child(self, name: str) -> RcutilsLogger:
        """The logger ``self.name``.``name``.

        Raises:
            ValueError: the name is empty.
        """
        if not name:
            raise ValueError("Child logger name must not be empty.")
        return get_logger(f"{self.name}.{name}" if self.name else name)

    def set_level(self, level: LoggingSeverity | int) -> None:
        """Drop lines below ``level``."""
        _levels[self.name] = LoggingSeverity(level)

    def get_effective_level(self) -> LoggingSeverity:
        """Its own level, or the nearest parent's, or INFO."""
        name = self.name
        while name:
            if _levels.get(name, LoggingSeverity.UNSET) != LoggingSeverity.UNSET:
                return _levels[name]
            name = name.rpartition(".")[0]
        return _levels.get("", LoggingSeverity.INFO)

    def is_enabled_for(self, severity: LoggingSeverity | int) -> bool:
        """Whether lines of that severity are kept."""
        return severity >= self.get_effective_level()

    def log(self, message: object, severity: LoggingSeverity | int, **filters: Any) -> bool:
        """Write a line; whether it was written.

        ``once``, ``skip_first`` and ``throttle_duration_sec`` (seconds) hold back lines of the same place
        in the program.

        Raises:
            TypeError: an unknown filter.
        """
        level = LoggingSeverity(severity)
        if not self.is_enabled_for(level) or (filters and not self._passes(filters)):
            return False
        host = current_host()
        if host.probe.visible:
            host.probe.logged(_SHOWN[level], self.name, str(message))
        else:
            stamp = host.clock.epoch + host.clock.now()
            print(line(_SHOWN[level], stamp, self.name, str(message)), file=sys.stderr)  # noqa: T201
        return True

    def _passes(self, filters: dict[str, Any]) -> bool:
        known = {"once", "skip_first", "throttle_duration_sec", "throttle_time_source_type"}
        if unknown := sorted(set(filters) - known):
            raise TypeError(f"invalid arguments for log call: {', '.join(unknown)}")
        site = self._sites.setdefault(_calling_place(), _Site())
        if filters.get("skip_first") and not site.skipped:
            site.skipped = True
            return False
        if filters.get("once") and site.spoken:
            return False
        throttle = filters.get("throttle_duration_sec")
        now = current_host().clock.now()
        if throttle and site.last is not None and now - site.last < throttle * 1e9:
            return False
        site.spoken = True
        site.last = now
        return True

    def debug(self, message: object, **filters: Any) -> bool:
        """Write a DEBUG line."""
        return self.log(message, LoggingSeverity.DEBUG, **filters)

    def info(self, message: object, **filters: Any) -> bool:
        """Write an INFO line."""
        return self.log(message, LoggingSeverity.INFO, **filters)

    def warning(self, message: object, **filters: Any) -> bool:
        """Write a WARN line."""
        return self.log(message, LoggingSeverity.WARN, **filters)

    def warn(self, message: object, **filters: Any) -> bool:
        """Write a WARN line."""
        return self.log(message, LoggingSeverity.WARN, **filters)

    def error(self, message: object, **filters: Any) -> bool:
        """Write an ERROR line."""
        return self.log(message, LoggingSeverity.ERROR, **filters)

    def fatal(self, message: object, **filters: Any) -> bool:
        """Write a FATAL line."""
        return self.log(message, LoggingSeverity.FATAL, **filters)


def get_logger(name: str) -> RcutilsLogger:
    """The logger of that name; the same object each time."""
    return _loggers.setdefault(name, RcutilsLogger(name))


def set_logger_level(name: str, level: LoggingSeverity | int, detailed_error: bool = False) -> None:  # noqa: ARG001
    """Drop the lines of a logger below ``level``."""
    get_logger(name).set_level(level)


def get_logger_level(name: str) -> LoggingSeverity:
    """A logger's own level, UNSET if it has none."""
    return _levels.get(name, LoggingSeverity.UNSET)


def get_logger_effective_level(name: str) -> LoggingSeverity:
    """The level that counts for a logger."""
    return get_logger(name).get_effective_level()


def _calling_place() -> tuple[str, int]:
    frame = sys._getframe(1)
    here = os.path.normcase(__file__)
    depth: Callable[[int], Any] = sys._getframe
    level = 1
    while os.path.normcase(frame.f_code.co_filename) == here:
        level += 1
        frame = depth(level)
    return frame.f_code.co_filename, frame.f_lineno
