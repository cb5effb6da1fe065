"""Measures how long this process waited for a CPU."""

from time import monotonic, process_time


def time_off_cpu() -> float:
    """Return the seconds without CPU time since an arbitrary origin."""
    return monotonic() - process_time()


def cpu_wait(since: float) -> float:
    """Return the seconds without CPU time since ``time_off_cpu`` returned ``since``.

    If the process had work all that time, it waited so long for a CPU.
    """
    return max(0.0, time_off_cpu() - since)
