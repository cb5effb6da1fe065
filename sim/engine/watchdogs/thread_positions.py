"""The line of a program at which a thread is, as ``node.py:12, in tick``."""

import sys

from sim.clock.virtual_threads import VirtualThread
from sim.probes import own_code


def place_of(thread: VirtualThread) -> str:
    """Return where a thread is."""
    return own_code.place_of(sys._current_frames().get(thread.ident)) or "somewhere"
