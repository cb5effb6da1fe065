"""Seconds, which programs and people give, as the nanoseconds that clocks count in."""

import math
from threading import TIMEOUT_MAX

SECOND = 1_000_000_000
"""Nanoseconds of a second."""


def wait_ns(seconds: float) -> int:
    """Return the nanoseconds of a wait, rounded up as by CPython.

    A positive wait, however short, lets time pass: otherwise a loop that waits for the rest of the time until
    a deadline would never reach it. A negative wait stays negative.

    Raises:
        ValueError: ``seconds`` is NaN.
        OverflowError: it is longer than CPython can wait, some 292 years.
    """
    if seconds > TIMEOUT_MAX:
        raise OverflowError("timestamp out of range for platform time_t")
    return math.ceil(seconds * 1e9)


def nearest_ns(seconds: float) -> int:
    """Return seconds that a person or a file gives as nanoseconds, rounded to the nearest."""
    return round(seconds * 1e9)
