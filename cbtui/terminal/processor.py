"""Measures how long this process waited for a processor."""

from time import monotonic, process_time


def time_off_cpu() -> float:
    """Seconds, counted from anywhere, in which no thread of this process computed."""
    return monotonic() - process_time()


def cpu_wait(since: float) -> float:
    """Seconds not computed since ``time_off_cpu`` returned ``since``.

    If there was something to compute all that time, so long did the machine let this process wait.
    """
    return max(0.0, time_off_cpu() - since)
