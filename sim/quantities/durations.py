"""Durations and moments of a run as text for people."""

from sim.quantities.nanoseconds import SECOND

_FORMS = (
    (99_500, 1_000, 0, "µs"),
    (9_950_000, 1_000_000, 1, "ms"),
    (999_500_000, 1_000_000, 0, "ms"),
    (99_950_000_000, SECOND, 1, "s"),
    (599_500_000_000, SECOND, 0, "s"),
)
"""For each: the durations below this limit (ns), the unit (ns), its decimals and its name."""


LEAST = 500
"""The shortest duration (ns) that is more than none when it is rounded."""


def duration(length: int) -> str:
    """Return a duration (nanoseconds) in few characters: ``12 µs``, ``0.8 ms``, ``9.9 s``, ``12 min``."""
    if abs(length) < LEAST:
        return "0 s"
    for limit, unit, decimals, name in _FORMS:
        if length < limit:
            return f"{length / unit:.{decimals}f} {name}"
    return f"{length / (60 * SECOND):.0f} min"


def timestamp(at: int) -> str:
    """Return a moment of a run (nanoseconds) to the millisecond: ``12.345 s``."""
    return f"{at / SECOND:.3f} s"
