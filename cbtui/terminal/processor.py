"""Measures how long this process waited for a processor."""

from time import monotonic, process_time


def not_computing() -> float:
    """Seconds, counted from anywhere, in which no thread of this process computed."""
    return monotonic() - process_time()


def waited(since: float) -> float:
    """Seconds not computed since ``not_computing`` returned ``since``.

    If there was something to compute all that time, so long did the machine let this process wait.
    """
    return max(0.0, not_computing() - since)
