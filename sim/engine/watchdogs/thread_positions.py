"""The line of a program at which a thread is or a lock was taken, as ``node.py:12, in tick``."""

import sys
from pathlib import Path
from types import CodeType

from sim.clock.virtual_threads import VirtualThread
from sim.probes import own_code


def place_of(thread: VirtualThread) -> str:
    """Return where a thread is."""
    return own_code.place_of(sys._current_frames().get(thread.ident)) or "somewhere"


def place_in(code: CodeType, offset: int) -> str:
    """Return the line of an instruction by its offset in the code."""
    lines = (line for start, end, line in code.co_lines() if start <= offset < end and line is not None)
    line = next(lines, code.co_firstlineno)
    return f"{Path(code.co_filename).name}:{line}, in {code.co_name}"
