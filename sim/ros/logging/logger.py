"""ROS loggers, with severities from DEBUG to FATAL."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any, Protocol

from sim.ros.logging.console import LogConsole
from sim.ros.logging.filters import CallSite, CallSiteFilters, calling_site
from sim.ros.logging.record import LogRecord
from sim.ros.logging.severity import LoggingSeverity
from sim.ros.middleware.process import current_process, process_local
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
    """Publishes the lines of a node's logger on ``/rosout``."""

    def log(self, record: LogRecord) -> None:
        """Publish a line."""


class Loggers:
    """The state of a process's loggers: their levels, and where their lines go."""

    def __init__(self) -> None:
        self.levels: dict[str, LoggingSeverity] = {}
        self.rosout: dict[str, Rosout] = {}
        self.rosout_enabled = True
        self.console_enabled = True


class _Console(LogConsole):
    """The log console for the environment of a process."""

    def __init__(self) -> None:
        super().__init__({**os.environ, **current_process().environment})


class RcutilsLogger:
    """A named logger. Lines below its level are dropped; without its own level it has its parent's.

    The lines of a node's logger and of its children from ``get_child`` are also published on ``/rosout``.
    """

    def __init__(self, name: str = "", *, rosout_name: str | None = None) -> None:
        self.name = name
        self._rosout_name = name if rosout_name is None else rosout_name
        self._places: dict[CallSite, CallSiteFilters] = {}

    def get_child(self, name: str) -> RcutilsLogger:
        """A logger called ``self.name``.``name``; ValueError if the name is empty."""
        if not name:
            raise ValueError("Child logger name must not be empty.")
        return RcutilsLogger(
            f"{self.name}.{name}" if self.name else name, rosout_name=self._rosout_name or name
        )

    def set_level(self, level: LoggingSeverity | int) -> None:
        """Drop lines below ``level``."""
        set_logger_level(self.name, level)

    def get_effective_level(self) -> LoggingSeverity:
        """The logger's own level, or the nearest parent's, or INFO."""
        return get_logger_effective_level(self.name)

    def is_enabled_for(self, severity: LoggingSeverity | int) -> bool:
        """Whether lines of a severity are written."""
        return LoggingSeverity(severity) >= self.get_effective_level()

    def log(self, message: object, severity: LoggingSeverity | int, **options: Any) -> bool:
        """Write a line; return whether it was written.

        ``once``, ``skip_first`` and ``throttle_duration_sec`` (seconds, on the clock
        ``throttle_time_source_type``) filter the lines of the same call site; ``name`` replaces
        the logger's name.

        Raises:
            TypeError: an option is unknown, or the message is not a text.
            ValueError: the call site had another severity, name or filter before.
        """
        if not self.is_enabled_for(severity):
            return False
        level = LoggingSeverity(severity)
        name = options.pop("name", self.name)
        where = calling_site()
        place = self._places.get(where)
        if place is None:
            place = self._places[where] = CallSiteFilters(name, level, options)
        else:
            place.require_same(name, level, options)
        if not place.lets_pass():
            return False
        self._write(LogRecord(level, name, _text_of(message), _stamp(), where))
        return True

    def _write(self, record: LogRecord) -> None:
        process = current_process()
        loggers = process.local(Loggers)
        if loggers.console_enabled:
            if process.output_listener is not None:
                process.local(_Console).hand_to(process.output_listener, record)
            probe = process.probe or process.host.probe
            if process.output_sink is not None:
                process.local(_Console).hand_to(process.output_sink, record)
            elif probe.visible:
                probe.logged(Severity[record.severity.name], record.logger, record.text)
            else:
                process.local(_Console).write(record)
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
    """The text of a message, as rclpy passes it to C."""
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
    """A logger of that name; ValueError if the name is empty."""
    if not name:
        raise ValueError("Logger name must not be empty.")
    return _root_logger.get_child(name)


def set_logger_level(name: str, level: LoggingSeverity | int, detailed_error: bool = False) -> None:  # noqa: ARG001
    """Drop the lines of a logger below ``level``; the empty name sets the default level."""
    process_local(Loggers).levels[name] = LoggingSeverity(level)


def get_logger_level(name: str) -> LoggingSeverity:
    """A logger's own level, or UNSET; for the empty name, the default level."""
    default = LoggingSeverity.UNSET if name else LoggingSeverity.INFO
    return process_local(Loggers).levels.get(name, default)


def get_logger_effective_level(name: str) -> LoggingSeverity:
    """A logger's own level, or the nearest parent's, or INFO."""
    while name:
        if (level := get_logger_level(name)) != LoggingSeverity.UNSET:
            return level
        name = name.rpartition(".")[0]
    return get_logger_level("") or LoggingSeverity.INFO


def get_logging_severity_from_string(log_severity: str) -> LoggingSeverity:
    """The severity of a name, in upper or lower case; RuntimeError if there is no such severity."""
    try:
        return LoggingSeverity[log_severity.upper()]
    except KeyError:
        raise RuntimeError("Failed to get severity name") from None


def get_logging_directory() -> Path:
    """ROS 2's folder of log files: ``$ROS_LOG_DIR``, ``$ROS_HOME/log`` or ``~/.ros/log``."""
    if chosen := os.environ.get("ROS_LOG_DIR"):
        return Path(chosen).expanduser()
    return Path(os.environ.get("ROS_HOME") or "~/.ros").expanduser() / "log"


def initialize() -> None:
    """Do nothing: logging needs no initialisation here."""


def shutdown() -> None:
    """Clear the levels of all loggers."""
    process_local(Loggers).levels.clear()


def clear_config() -> None:
    """Clear the levels of all loggers."""
    shutdown()


def send_to(*, console: bool | None, rosout: bool | None) -> None:
    """Switch the output to the console and to ``/rosout`` on or off; None: leave it as it is."""
    loggers = process_local(Loggers)
    if console is not None:
        loggers.console_enabled = console
    if rosout is not None:
        loggers.rosout_enabled = rosout


def _stamp() -> int:
    clock = current_process().host.clock
    return clock.epoch + clock.now()


_root_logger = RcutilsLogger()
