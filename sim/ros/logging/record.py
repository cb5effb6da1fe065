"""A log line before it is written anywhere."""

from __future__ import annotations

from typing import NamedTuple

from sim.ros.logging.filters import CallSite
from sim.ros.logging.severity import LoggingSeverity


class LogRecord(NamedTuple):
    """What was logged, by which logger, and where; ``stamp`` is nanoseconds since 1970."""

    severity: LoggingSeverity
    logger: str
    text: str
    stamp: int
    place: CallSite
