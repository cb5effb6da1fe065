"""Processes that others started, looked up in Linux's ``/proc``."""

import time
from pathlib import Path

_LIMIT = 60.0
"""Seconds after which a process that should have ended counts as left."""


def descendants(process: int) -> list[int]:
    """Return the numbers of all processes that a process started, and that those started."""
    found = [process]
    for each in found:
        for task in Path(f"/proc/{each}/task").glob("*/children"):
            found += map(int, task.read_text().split())
    return found[1:]


def engines_of(console: int) -> list[int]:
    """Return the numbers of a console's engines, from their first moment on."""
    children = Path(f"/proc/{console}/task/{console}/children").read_text(encoding="utf-8").split()
    return [int(each) for each in children if b"spawn_main" in Path(f"/proc/{each}/cmdline").read_bytes()]


def alive(process: int) -> bool:
    """Tell whether a process still does something."""
    return _state(process) not in "ZX"


def wait_until_gone(processes: list[int]) -> None:
    """Wait until none of them does anything: whoever watches over an engine ends a moment after it."""
    end = time.monotonic() + _LIMIT
    while any(map(alive, processes)):
        assert time.monotonic() < end, "a process is left"
        time.sleep(0.01)


def is_stopped(process: int) -> bool:
    """Tell whether a process was stopped by a signal."""
    return _state(process) == "T"


def _state(process: int) -> str:
    """The letter of its state in ``/proc``; X, which is dead, for one that is gone."""
    try:
        return Path(f"/proc/{process}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()[0]
    except (FileNotFoundError, ProcessLookupError):
        return "X"
