"""What a process takes of the machine, and whether that grows."""

from collections.abc import Sequence
from statistics import median
from typing import NamedTuple

import psutil


class Footprint(NamedTuple):
    """Bytes that are in memory, threads, and open files of a process at one moment."""

    memory: int
    threads: int
    files: int


def footprint(process: int | None = None) -> Footprint | None:
    """Look at a process, None for this one; None if it has ended."""
    try:
        seen = psutil.Process(process)
        return Footprint(seen.memory_info().rss, seen.num_threads(), seen.num_fds())
    except psutil.Error:
        return None


def growth(values: Sequence[float]) -> float:
    """By how much the last third of the values lies above the middle one; the first is for warming up.

    Medians are compared, so that a moment at which much was held does not count.
    """
    third = len(values) // 3
    if third == 0:
        return 0.0
    return median(values[-third:]) - median(values[third : 2 * third])
