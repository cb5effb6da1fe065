"""Lengths of time in few characters."""

from sim.trace.model import Nanoseconds


def duration(length: Nanoseconds) -> str:
    """Return a length of time as a person would say it: ``0.8 ms``, ``350 ms``, ``8.9 s``, ``12 min``."""
    seconds = length / 1e9
    if seconds < 0.000_05:
        return f"{seconds * 1e6:.0f} us"
    if seconds < 0.00995:
        return f"{seconds * 1e3:.1f} ms"
    if seconds < 0.9995:
        return f"{seconds * 1e3:.0f} ms"
    if seconds < 99.95:
        return f"{seconds:.1f} s"
    if seconds < 599.5:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min"
