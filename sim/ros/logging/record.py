"""A log line before it is written anywhere."""

from typing import NamedTuple

from sim.ros.logging.filters import CallSite
from sim.ros.logging.severity import LoggingSeverity


class LogRecord(NamedTuple):
    """A log line, its logger and its call site; ``stamp`` is nanoseconds since 1970."""

    severity: LoggingSeverity
    logger: str
    text: str
    stamp: int
    call_site: CallSite
