"""Puts into words what a thread of virtual time waits for without an end, and who would have to end that.

What is said is one sentence, and behind its last semicolon what to do.
"""

import sys
import threading
from collections.abc import Sequence
from itertools import takewhile

from sim.clock.virtual_threads import VirtualThread
from sim.engine.watchdogs.places import place_in, place_of
from sim.probes.own_code import is_own, outwards

_AWAITS = threading.Condition.wait.__code__
"""What every wait of Python's own comes to that is not for a lock."""


def deadlock_of_circle(circle: Sequence[VirtualThread]) -> str:
    """Tell of threads that wait for each other's locks or ends, or of one that waits for its own lock."""
    chain = ", and ".join(_waits(each) for each in circle)
    if any(_waits_for_end(each) for each in circle):
        return f"deadlock: {chain}; let go of locks before you wait for a thread to end"
    if len(circle) > 1:
        return f"deadlock: {chain}; take locks in the same order everywhere"
    return f"deadlock: {chain}; take it once, let go of it before, or use threading.RLock"


def deadlock_of_last(thread: VirtualThread) -> str:
    """Tell of a thread that waits when no thread of its program is left to end that."""
    told = f"deadlock: {_waits(thread)}, and no thread of the program is left that could end that"
    return f"{told}; {_cure(thread)}"


def long_wait(thread: VirtualThread, lasted: int) -> str:
    """Tell of a thread that has waited for so many nanoseconds for what somebody might still do."""
    seconds = f"{lasted / 1e9:.1f}".removesuffix(".0")
    return f"{_waits(thread)}, for {seconds} s already; {_cure(thread)}"


def _waits(thread: VirtualThread) -> str:
    return f"{thread.name} ({place_of(thread)}) {_what(thread)}"


def _what(thread: VirtualThread) -> str:
    signal = _signal(thread)
    if signal:
        return f"waits in {signal}()"
    lock = thread.wants
    if lock is None or lock.holder is None:
        return "waits for a lock"
    if lock.taken_at is None:
        return f"waits for {lock.holder.name} to end"
    who = "it took itself" if lock.holder is thread else f"{lock.holder.name} took"
    return f"waits for the lock that {who} at {place_in(*lock.taken_at)}"


def _signal(thread: VirtualThread) -> str:
    """The function of Python's that waits for what another thread is to do: ``Event.wait``; "" for a lock."""
    if thread.wants is None or thread.wants.holder is not thread:
        return ""
    library = [
        frame.f_code
        for frame in takewhile(
            lambda frame: not is_own(frame), outwards(sys._current_frames().get(thread.ident))
        )
    ]
    return library[-1].co_qualname if _AWAITS in library else ""


def _cure(thread: VirtualThread) -> str:
    if _signal(thread):
        return "wait with a timeout, and let a callback of another group, on another thread, end it"
    if _waits_for_end(thread):
        return "see that the thread ends, or join it with a timeout"
    return "take locks by with, which lets go of them whatever happens"


def _waits_for_end(thread: VirtualThread) -> bool:
    return thread.wants is not None and thread.wants.holder is not None and thread.wants.taken_at is None
