"""Cycles in the wait-for graph of threads: each waits for a lock that the next one holds, or for its end."""

from types import CodeType
from typing import Protocol

from sim.clock.virtual_threads import VirtualThread


class HeldResource(Protocol):
    """A lock, or a thread's end, as far as its holder matters."""

    holder: VirtualThread | None
    """The thread of the clock that has it; the one that is to end."""
    guards: bool
    """Whether only its holder can end the wait: it was taken in such a way, or is a thread's end."""
    taken_at: tuple[CodeType, int] | None
    """Where in the program a lock was taken last: the code, and how far in; None for a thread's end."""


def cycle_of(thread: VirtualThread) -> list[VirtualThread]:
    """The threads that wait for each other in a circle through ``thread``, which comes first.

    Empty where there is no such circle. A thread that waits for what it took itself makes one only where the
    lock guards something: else it can be a signal that another thread gives.
    """
    chain = [thread]
    wanted: HeldResource | None = thread.wants
    while wanted is not None and wanted.holder is not None:
        holder = wanted.holder
        if holder in chain:
            return chain if holder is thread and (len(chain) > 1 or wanted.guards) else []
        chain.append(holder)
        wanted = holder.wants
    return []


def lasts(circle: list[VirtualThread]) -> bool:
    """Whether a circle stands for ever: no lock in it can be a signal that comes from outside it."""
    return bool(circle) and all(each.wants is not None and each.wants.guards for each in circle)
