"""Loggers: lines as ROS prints them, from DEBUG to FATAL."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any, Protocol

from sim.ros.logging.console import LogConsole
from sim.ros.logging.filters import CallSite, LogPlace, calling_place
from sim.ros.logging.record import LogRecord
from sim.ros.logging.severity import LoggingSeverity
from sim.ros.middleware.process import current_process, of_process
from sim.trace.events import Severity

__all__ = [
    "LoggingSeverity",
    "RcutilsLogger",
    "clear_config",
    "get_logger",
    "get_logger_effective_level",
    "get_logger_level",
    "get_logging_directory",
    "get_logging_severity_from_string",
    "initialize",
    "set_logger_level",
    "shutdown",
]


class Rosout(Protocol):
    """What takes the lines of a node's logger to ``/rosout``."""

    def log(self, record: LogRecord) -> None:
        """Publish a line."""


class Loggers:
    """What a process keeps of its loggers: their levels, and where their lines go."""

    def __init__(self) -> None:
        self.levels: dict[str, LoggingSeverity] = {}
        self.rosout: dict[str, Rosout] = {}
        self.rosout_enabled = True
        self.console_enabled = True


class _Console(LogConsole):
    """The terminal as the environment of a process wants it."""

    def __init__(self) -> None:
        super().__init__({**os.environ, **current_process().environment})


class RcutilsLogger:
    """A named logger. Lines below its level are dropped; without a level of its own, its parent's counts.

    The lines of a node's logger, and of loggers made by ``get_child`` from that, go to ``/rosout`` too.
    """

    def __init__(self, name: str = "", *, rosout_name: str | None = None) -> None:
        self.name = name
        self._rosout_name = name if rosout_name is None else rosout_name
        self._places: dict[CallSite, LogPlace] = {}

    def get_child(self, name: str) -> RcutilsLogger:
        """The logger ``self.name``.``name``.

        Raises:
            ValueError: the name is empty.
        """
        if not name:
            raise ValueError("Child logger name must not be empty.")
        return RcutilsLogger(
            f"{self.name}.{name}" if self.name else name, rosout_name=self._rosout_name or name
        )

    def set_level(self, level: LoggingSeverity | int) -> None:
        """Drop lines below ``level``."""
        set_logger_level(self.name, level)

    def get_effective_level(self) -> LoggingSeverity:
        """Its own level, or the nearest parent's, or INFO."""
        return get_logger_effective_level(self.name)

    def is_enabled_for(self, severity: LoggingSeverity | int) -> bool:
        """Whether lines of that severity are kept."""
        return LoggingSeverity(severity) >= self.get_effective_level()

    def log(self, message: object, severity: LoggingSeverity | int, **options: Any) -> bool:
        """Write a line; whether it was written.

        ``once``, ``skip_first`` and ``throttle_duration_sec`` (seconds, on the clock
        ``throttle_time_source_type``) hold back lines of the same place in the program; ``name`` stands in
        for the logger's own.

        Raises:
            TypeError: an unknown option, or a message to be written that is no text.
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
        self._write(LogRecord(level, name, _text_of(message), _stamp(), where))
        return True

    def _write(self, record: LogRecord) -> None:
        process = current_process()
        loggers = process.keep(Loggers)
        if loggers.console_enabled:
            if process.hear_output is not None:
                process.keep(_Console).hand_to(process.hear_output, record)
            probe = process.probe or process.host.probe
            if process.take_output is not None:
                process.keep(_Console).hand_to(process.take_output, record)
            elif probe.visible:
                probe.logged(Severity[record.severity.name], record.logger, record.text)
            else:
                process.keep(_Console).write(record)
        rosout = loggers.rosout.get(self._rosout_name)
        if rosout is not None:
            rosout.log(record)

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


def _text_of(message: object) -> str:
    """What is written of a message, as rclpy hands it on to C."""
    if isinstance(message, str):
        return message
    if message is None:
        return "(null)"
    if isinstance(message, bytes):
        return message.decode()
    raise TypeError(
        f"rclpy_logging_rcutils_log(): incompatible function arguments: the message has to be a str, not "
        f"{type(message).__name__}; write str(...) or an f-string around it"
    )


def get_logger(name: str) -> RcutilsLogger:
    """A logger of that name.

    Raises:
        ValueError: the name is empty.
    """
    if not name:
        raise ValueError("Logger name must not be empty.")
    return _root_logger.get_child(name)


def set_logger_level(name: str, level: LoggingSeverity | int, detailed_error: bool = False) -> None:  # noqa: ARG001
    """Drop the lines of a logger below ``level``; an empty name means all that have no level."""
    of_process(Loggers).levels[name] = LoggingSeverity(level)


def get_logger_level(name: str) -> LoggingSeverity:
    """A logger's own level, UNSET if it has none; of the empty name, the level of all that have none."""
    default = LoggingSeverity.UNSET if name else LoggingSeverity.INFO
    return of_process(Loggers).levels.get(name, default)


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
        raise RuntimeError("Failed to get severity name") from None


def get_logging_directory() -> Path:
    """Where ROS 2 keeps its logs: ``$ROS_LOG_DIR``, ``$ROS_HOME/log`` or ``~/.ros/log``."""
    if chosen := os.environ.get("ROS_LOG_DIR"):
        return Path(chosen).expanduser()
    return Path(os.environ.get("ROS_HOME") or "~/.ros").expanduser() / "log"


def initialize() -> None:
    """Begin logging, which needs no beginning here."""


def shutdown() -> None:
    """Forget the levels of all loggers."""
    of_process(Loggers).levels.clear()


def clear_config() -> None:
    """Forget the levels of all loggers."""
    shutdown()


def send_to(*, console: bool | None, rosout: bool | None) -> None:
    """Have lines go, or not go, to the console and to ``/rosout``; None: as before."""
    loggers = of_process(Loggers)
    if console is not None:
        loggers.console_enabled = console
    if rosout is not None:
        loggers.rosout_enabled = rosout


def _stamp() -> int:
    clock = current_process().host.clock
    return clock.epoch + clock.now()


_root_logger = RcutilsLogger()
