"""Cycles in the wait-for graph of threads: each waits for a lock of the next one, or for its end."""

from sim.clock.virtual_threads import HeldResource, VirtualThread


def cycle_of(thread: VirtualThread) -> list[VirtualThread]:
    """The threads of the wait cycle through ``thread``, which comes first.

    Empty without a cycle. A thread that waits for its own lock is a cycle only if the lock ``guards``:
    otherwise the lock may be a signal that another thread releases.
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


def lasts(cycle: list[VirtualThread]) -> bool:
    """Whether a cycle is permanent: no lock in it can be released from outside."""
    return bool(cycle) and all(each.wants is not None and each.wants.guards for each in cycle)
