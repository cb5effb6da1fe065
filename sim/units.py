"""Seconds, which programs and people give, as the nanoseconds in which clocks count."""

import math
from threading import TIMEOUT_MAX

SECOND = 1_000_000_000
"""Nanoseconds of a second."""


def wait_ns(seconds: float) -> int:
    """Nanoseconds of a wait, rounded up as by CPython: a positive one lets time pass, however short it is.

    Without that, a loop that waits for what is left until a deadline would stay in front of it for ever.
    What is not positive stays so.

    Raises:
        ValueError: it is NaN.
        OverflowError: it is longer than CPython can wait, some 292 years.
    """
    if seconds > TIMEOUT_MAX:
        raise OverflowError("timestamp out of range for platform time_t")
    return math.ceil(seconds * 1e9)


def nearest_ns(seconds: float) -> int:
    """Nanoseconds of a moment that a person or a file gives in seconds, to the nearest one."""
    return round(seconds * 1e9)
