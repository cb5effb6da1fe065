"""Circles of threads each of which waits for a lock that the next one holds."""

from typing import Protocol

from sim.clock.virtual_threads import VirtualThread


class Held(Protocol):
    """A lock, as far as its holder matters."""

    holder: VirtualThread | None


def circle_of(thread: VirtualThread) -> list[VirtualThread]:
    """The threads that wait for each other's locks in a circle through ``thread``, which comes first.

    None where there is no such circle. A thread that waits for what it took itself makes none: a lock can be
    a signal that another one gives.
    """
    chain = [thread]
    wanted: Held | None = thread.wants
    while wanted is not None and wanted.holder is not None:
        holder = wanted.holder
        if holder in chain:
            return chain if holder is thread and len(chain) > 1 else []
        chain.append(holder)
        wanted = holder.wants
    return []
