"""Names of callbacks, groups and executors for the sentences of rules."""

from collections.abc import Iterable
from pathlib import Path

from sim.quantities.durations import timestamp
from sim.quantities.nanoseconds import SECOND
from sim.trace.descriptions import name_of, node_name, waiting_name
from sim.trace.events import EntityId, EntityKind
from sim.trace.model import Blocked, EntityInfo, Moment, Nanoseconds, Position, ThreadInfo, Window
from sim.trace.timeline import Timeline

SPIN_ALWAYS = "do one step of the loop in a timer's callback, and call rclpy.spin(node)"
"""The cure of a program whose loop spins too rarely, or never."""

SPIN_BESIDE = "spin the node in a thread beside the loop: Thread(target=rclpy.spin, args=(node,)).start()"
"""The cure of a program whose loop sleeps by a rate, and that spins nothing."""

SPIN_ONCE = "add all nodes to one executor by add_node(), and spin that, once"
"""The cure of a program that spins one node after another."""


def who(entity: EntityId, timeline: Timeline) -> str:
    """Return the name of a callback; for a client, the reply that it waits for.

    Of those that share a name, it has its topic or service, or its node, in brackets.
    """
    known = timeline.entities.get(entity)
    if known is None:
        return name_of(entity, timeline)
    if known.kind is EntityKind.CLIENT:
        return f"the reply of {known.name}"
    name = known.spoken_name

    def apart(each: EntityInfo) -> str:
        return node_name(each.node, timeline) if each.name in ("", name) else each.name

    others = {apart(each) for each in timeline.entities.values() if each.spoken_name == name}
    return f"{name} ({apart(known)})" if len(others) > 1 else name


def who_waits(entity: EntityId, during: Window, timeline: Timeline) -> str:
    """Return the name of what waits: as ``who``, but of an action's server what it is asked meanwhile."""
    known = timeline.entities.get(entity)
    is_action = known is not None and known.kind is EntityKind.WAITABLE
    return waiting_name(entity, during, timeline) if is_action else who(entity, timeline)


def awaited_lock(position: Position, timeline: Timeline, more: str = "") -> str:
    """Return the lock for which a callback waits, who took it, and where, as far as that is known.

    ``more`` is what has become of it: `` and keeps while it awaits``.
    """
    taker, itself = lock_taker(position, timeline), ""
    if position.is_left:
        more = " and did not release before it ended"
    elif position.keeper:
        more = more or " and did not release"
        taker = "an earlier call" if position.keeper == position.entity else taker
    elif position.holder == position.thread:
        taker, itself = "it", " itself"
    file, line = position.taken_at
    where = f" at {Path(file).name}:{line}" if file else ""
    return f"{position.lock or 'a lock'}{f', which {taker} took{itself}{where}{more}' if taker else ''}"


def lock_taker(position: Position, timeline: Timeline) -> str:
    """Return the callback that took the lock for which another one waits, else the thread; "" if unknown."""
    keeper = lock_keeper(position, timeline)
    return who(keeper, timeline) if keeper else position.taken_by


def lock_keeper(position: Position, timeline: Timeline) -> EntityId:
    """Return the callback that took the lock for which another one waits; 0 if none is known to."""
    spans = timeline.spans_on(position.holder, Window(position.start, position.start + 1))
    return position.keeper or (spans[-1].entity if spans else 0)


def must_answer(entity: EntityId, timeline: Timeline) -> bool:
    """Return whether a callback has to return something, as a service's does: it cannot go on later."""
    known = timeline.entities.get(entity)
    return known is not None and known.kind in (EntityKind.SERVICE, EntityKind.WAITABLE)


def awaiting(entity: EntityId, timeline: Timeline) -> str:
    """The cure of a callback that waits for a future, as a coroutine; a task is in no group."""
    own_group = "" if is_task(entity, timeline) else " with a callback group of its own"
    return f"await the future in an async def {who(entity, timeline)}{own_group}"


def is_task(entity: EntityId, timeline: Timeline) -> bool:
    """Return whether an entity is a function that an executor runs as a task, in no group."""
    known = timeline.entities.get(entity)
    return known is not None and known.kind is EntityKind.TASK


def group_of(entity: EntityId, timeline: Timeline) -> str:
    """The group of an entity: ``group A``."""
    known = timeline.entities.get(entity)
    group = None if known is None else timeline.groups.get(known.group)
    return "its group" if group is None else f"group {group.letter}"


def listed(names: Iterable[str]) -> str:
    """Names as an enumeration: ``a, b and c``."""
    *others, last = dict.fromkeys(names)
    return f"{', '.join(others)} and {last}" if others else last


def often(count: int, what: str = "times in all") -> str:
    """Return a number of occurrences in brackets; empty for one."""
    return f" ({count} {what})" if count > 1 else ""


def until_when(ends: Nanoseconds, timeline: Timeline) -> str:
    """When a wait is over at the latest: `` until 9.0 s``; empty for 0, and for what should be over."""
    return f" until {ends / SECOND:.1f} s" if ends > timeline.end else ""


def threads_needed(peak: int, count: int, at: Nanoseconds, timeline: Timeline) -> str:
    """Return how many threads ran callbacks at once up to a moment, in words that say nothing of later."""
    was = "was" if peak == 1 else "were"
    if timeline.ended is None or at < timeline.end:
        return f"so far {peak} of {count} threads {was} needed at once"
    return f"{peak} of {count} threads {was} ever needed at once"


def late_reply(blocked: Blocked, moment: Moment, timeline: Timeline) -> str:
    """Say that a call's reply was taken and its caller not woken, which needs a thread, too; else "".

    While a thread is free, the caller is woken in the very moment in which its reply is taken.
    """
    window = Window(blocked.start, moment.at + 1)
    clients = [
        each.id
        for each in timeline.entities.values()
        if each.kind is EntityKind.CLIENT and each.name == blocked.service
    ]
    spans = (span for client in clients for span in timeline.spans_of(client, window))
    taken = [span.end for span in spans if span.message == blocked.call and span.end is not None]
    if not taken or taken[0] > moment.at:
        return ""
    who = name_of(blocked.entity, timeline) if blocked.entity else "the program"
    is_full = len(moment.running) >= thread_count(timeline)
    if taken[0] == moment.at and not is_full:
        return f"{who} has its reply from {blocked.service}, and is about to go on"
    why = "no thread is free to hand it over" if is_full else "the executor has yet to hand it over"
    return f"{who} has had its reply from {blocked.service} since {timestamp(taken[0])}, but {why}"


def thread_count(timeline: Timeline) -> int:
    """The total number of threads of a run's executors.

    One that a callback made, such as that of a nested ``rclpy.spin_until_future_complete``, spins on the
    callback's own thread and adds none.
    """
    return sum(
        executor.threads
        for executor in timeline.executors.values()
        if executor.threads > 1 or not executor.is_nested
    )


def only_thread(timeline: Timeline) -> str:
    """What the one thread of a callback's executor is called; other executors may have threads too."""
    return "its only thread" if thread_count(timeline) > 1 else "the only thread"


def threads_for(entities: Iterable[EntityId], at: Nanoseconds, timeline: Timeline) -> int:
    """The number of threads of the executor that ran the first known one of some entities, by ``at``.

    1 for an executor without workers, which runs callbacks on the spinning thread, and for an unknown one.
    """
    for entity in entities:
        if (thread := thread_of(entity, at, timeline)) is not None:
            executor = timeline.executors.get(thread.executor)
            return 1 if executor is None else executor.threads
    return 1


def thread_of(entity: EntityId, at: Nanoseconds, timeline: Timeline) -> ThreadInfo | None:
    """The thread that ran an entity's callback last, by ``at``."""
    last = timeline.spans_of(entity, Window(0, at + 1))[-1:]
    return timeline.threads.get(last[0].thread) if last else None


def with_threads(threads: int) -> str:
    """The executor with a number of threads, as code."""
    return f"MultiThreadedExecutor(num_threads={threads})"
