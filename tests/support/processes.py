"""Processes that others started, looked up in Linux's ``/proc``."""

from pathlib import Path


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


def is_stopped(process: int) -> bool:
    """Tell whether a process was stopped by a signal."""
    return _state(process) == "T"


def _state(process: int) -> str:
    """The letter of its state in ``/proc``; X, which is dead, for one that is gone."""
    try:
        return Path(f"/proc/{process}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()[0]
    except (FileNotFoundError, ProcessLookupError):
        return "X"
