"""Log lines on a terminal, in rcutils' format and with its environment variables."""

import re
import sys
from collections.abc import Callable, Mapping
from datetime import datetime

from sim.ros.logging.record import LogRecord
from sim.ros.logging.severity import LoggingSeverity

_FORMAT = "RCUTILS_CONSOLE_OUTPUT_FORMAT"
_STDOUT = "RCUTILS_LOGGING_USE_STDOUT"
_COLOURS = "RCUTILS_COLORIZED_OUTPUT"

_DEFAULT_FORMAT = "[{severity}] [{time}] [{name}]: {message}"
_TOKEN = re.compile(r"\{(\w+)\}")
_ESCAPE = re.compile(r"\\(a|b|n|r|t|x1b)")
_ESCAPES = {"a": "\a", "b": "\b", "n": "\n", "r": "\r", "t": "\t", "x1b": "\x1b"}

_PLAIN = "\033[0m"
_COLOUR_OF = {
    LoggingSeverity.DEBUG: "\033[32m",
    LoggingSeverity.INFO: _PLAIN,
    LoggingSeverity.WARN: "\033[33m",
    LoggingSeverity.ERROR: "\033[31m",
    LoggingSeverity.FATAL: "\033[31m",
}


def _time(record: LogRecord) -> str:
    seconds, nanoseconds = divmod(record.stamp, 1_000_000_000)
    return f"{seconds}.{nanoseconds:09d}"


def _date(record: LogRecord) -> str:
    moment = datetime.fromtimestamp(record.stamp / 1e9)
    return f"{moment:%Y-%m-%d %H:%M:%S}.{record.stamp // 1_000_000 % 1000:03d}"


_TOKENS: dict[str, Callable[[LogRecord], str]] = {
    "severity": lambda record: record.severity.name,
    "name": lambda record: record.logger,
    "message": lambda record: record.text,
    "function_name": lambda record: record.call_site.function,
    "file_name": lambda record: record.call_site.file,
    "line_number": lambda record: str(record.call_site.line),
    "time": _time,
    "time_as_nanoseconds": lambda record: f"{record.stamp:019d}",
    "date_time_with_ms": _date,
}


class LogConsole:
    """Writes log lines to stderr, or to stdout if the environment says so.

    Lines are coloured on a terminal, or as the environment says. An invalid variable is reported once, on
    stderr, and ignored.
    """

    def __init__(self, environment: Mapping[str, str]) -> None:
        text = environment.get(_FORMAT) or _DEFAULT_FORMAT
        self._format = _ESCAPE.sub(lambda found: _ESCAPES[found[1]], text)
        self._to_stdout = _switch(environment, _STDOUT) is True
        self._coloured = _switch(environment, _COLOURS)

    def write(self, record: LogRecord) -> None:
        """Write a line."""
        stream = sys.stdout if self._to_stdout else sys.stderr
        line = self.line(record)
        if stream.isatty() if self._coloured is None else self._coloured:
            line = f"{_COLOUR_OF[record.severity]}{line}{_PLAIN}"
        print(line, file=stream, flush=True)

    def hand_to(self, take: Callable[[str, bool], None], record: LogRecord) -> None:
        """Call ``take`` with each line of a record, without colours, and whether it is for stderr."""
        for line in self.line(record).split("\n"):
            take(line, not self._to_stdout)

    def line(self, record: LogRecord) -> str:
        """The line without colours; unknown tokens stay as they are."""

        def value(found: re.Match[str]) -> str:
            token = _TOKENS.get(found[1])
            return found[0] if token is None else token(record)

        return _TOKEN.sub(value, self._format)


def _switch(environment: Mapping[str, str], name: str) -> bool | None:
    """The value of a variable that is 0 or 1; None if it is not set."""
    value = environment.get(name, "")
    if value not in {"", "0", "1"}:
        print(f"{name} is {value!r}: the valid values are 1 and 0", file=sys.stderr)  # noqa: T201
        return None
    return value == "1" if value else None
