"""What a process takes of the machine, and whether that grows."""

from collections.abc import Sequence
from pathlib import Path
from statistics import median
from typing import NamedTuple

_PAGE = 4096


class Footprint(NamedTuple):
    """Bytes that are in memory, threads, and open files of a process at one moment."""

    memory: int
    threads: int
    files: int


def footprint(process: int | str = "self") -> Footprint | None:
    """Look at a process (Linux only); None if it has ended."""
    place = Path("/proc") / str(process)
    try:
        pages = int((place / "statm").read_text().split()[1])
        return Footprint(
            pages * _PAGE, len(list((place / "task").iterdir())), len(list((place / "fd").iterdir()))
        )
    except (OSError, IndexError):
        return None


def growth(values: Sequence[float]) -> float:
    """By how much the last third of the values lies above the middle one; the first is for warming up.

    Medians are compared, so that a moment at which much was held does not count.
    """
    third = len(values) // 3
    if third == 0:
        return 0.0
    return median(values[-third:]) - median(values[third : 2 * third])
