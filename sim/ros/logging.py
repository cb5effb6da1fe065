"""Loggers: lines as ROS prints them, from DEBUG to FATAL."""

from __future__ import annotations

import os
import sys
from enum import IntEnum
from pathlib import Path
from typing import Any

from sim.ros.log_filters import LogPlace, Place, calling_place
from sim.ros.process import current_process, of_process
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


class _Loggers:
    """The loggers of a process and the levels that were set."""

    def __init__(self) -> None:
        self.levels: dict[str, LoggingSeverity] = {}
        self.by_name: dict[str, RcutilsLogger] = {}


def line(severity: Severity, stamp: int, logger: str, text: str) -> str:
    """A log line as ROS prints it; ``stamp`` is nanoseconds since 1970."""
    seconds, nanoseconds = divmod(stamp, 1_000_000_000)
    return f"[{severity}] [{seconds}.{nanoseconds:09d}] [{logger}]: {text}"


class RcutilsLogger:
    """A named logger. Lines below its level are dropped; without a level of its own, its parent's counts."""

    def __init__(self, name: str = "") -> None:
        self.name = name
        self._places: dict[Place, LogPlace] = {}

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
        set_logger_level(self.name, level)

    def get_effective_level(self) -> LoggingSeverity:
        """Its own level, or the nearest parent's, or INFO."""
        return get_logger_effective_level(self.name)

    def is_enabled_for(self, severity: LoggingSeverity | int) -> bool:
        """Whether lines of that severity are kept."""
        return severity >= self.get_effective_level()

    def log(self, message: object, severity: LoggingSeverity | int, **options: Any) -> bool:
        """Write a line; whether it was written.

        ``once``, ``skip_first`` and ``throttle_duration_sec`` (seconds, on the clock
        ``throttle_time_source_type``) hold back lines of the same place in the program; ``name`` stands in
        for the logger's own.

        Raises:
            TypeError: an unknown option.
            ValueError: the place asked for another severity, name or filter before.
        """
        if not self.is_enabled_for(severity):
            return False
        level = LoggingSeverity(severity)
        name = options.pop("name", self.name)
        where = calling_place()
        place = self._places.get(where)
        if place is None:
            place = self._places[where] = LogPlace(name, level, options)
        else:
            place.require_same(name, level, options)
        if not place.lets_pass():
            return False
        process = current_process()
        host = process.host
        probe = process.probe or host.probe
        if probe.visible:
            probe.logged(_SHOWN[level], name, str(message))
        else:
            stamp = host.clock.epoch + host.clock.now()
            print(line(_SHOWN[level], stamp, name, str(message)), file=sys.stderr)  # noqa: T201
        return True

    def debug(self, message: object, **options: Any) -> bool:
        """Write a DEBUG line."""
        return self.log(message, LoggingSeverity.DEBUG, **options)

    def info(self, message: object, **options: Any) -> bool:
        """Write an INFO line."""
        return self.log(message, LoggingSeverity.INFO, **options)

    def warning(self, message: object, **options: Any) -> bool:
        """Write a WARN line."""
        return self.log(message, LoggingSeverity.WARN, **options)

    def warn(self, message: object, **options: Any) -> bool:
        """Write a WARN line."""
        return self.log(message, LoggingSeverity.WARN, **options)

    def error(self, message: object, **options: Any) -> bool:
        """Write an ERROR line."""
        return self.log(message, LoggingSeverity.ERROR, **options)

    def fatal(self, message: object, **options: Any) -> bool:
        """Write a FATAL line."""
        return self.log(message, LoggingSeverity.FATAL, **options)


def get_logger(name: str) -> RcutilsLogger:
    """The logger of that name; the same object each time.

    Raises:
        ValueError: the name is empty.
    """
    if not name:
        raise ValueError("Logger name must not be empty.")
    return of_process(_Loggers).by_name.setdefault(name, RcutilsLogger(name))


def set_logger_level(name: str, level: LoggingSeverity | int, detailed_error: bool = False) -> None:  # noqa: ARG001
    """Drop the lines of a logger below ``level``; an empty name means all that have no level."""
    of_process(_Loggers).levels[name] = LoggingSeverity(level)


def get_logger_level(name: str) -> LoggingSeverity:
    """A logger's own level, UNSET if it has none."""
    return of_process(_Loggers).levels.get(name, LoggingSeverity.UNSET)


def get_logger_effective_level(name: str) -> LoggingSeverity:
    """The level that counts for a logger: its own, or the nearest parent's, or INFO."""
    while name:
        if (level := get_logger_level(name)) != LoggingSeverity.UNSET:
            return level
        name = name.rpartition(".")[0]
    return get_logger_level("") or LoggingSeverity.INFO


def get_logging_severity_from_string(log_severity: str) -> LoggingSeverity:
    """The severity of that name, in letters of any size.

    Raises:
        RuntimeError: there is none.
    """
    try:
        return LoggingSeverity[log_severity.upper()]
    except KeyError:
        raise RuntimeError(f'Failed to get log severity from name: "{log_severity}"') from None


def get_logging_directory() -> Path:
    """Where ROS 2 keeps its logs: ``$ROS_LOG_DIR``, ``$ROS_HOME/log`` or ``~/.ros/log``."""
    if chosen := os.environ.get("ROS_LOG_DIR"):
        return Path(chosen).expanduser()
    return Path(os.environ.get("ROS_HOME") or "~/.ros").expanduser() / "log"


def initialize() -> None:
    """Begin logging, which needs no beginning here."""


def shutdown() -> None:
    """Forget the levels of all loggers."""
    of_process(_Loggers).levels.clear()
