"""How rules name callbacks, groups and executors in their sentences."""

from collections.abc import Iterable

from sim.trace.descriptions import name_of
from sim.trace.events import EntityId, EntityKind
from sim.trace.model import Nanoseconds, Window
from sim.trace.timeline import Timeline


def who(entity: EntityId, timeline: Timeline) -> str:
    """A callback by its name; a client by what it waits for."""
    known = timeline.entities.get(entity)
    if known is not None and known.kind is EntityKind.CLIENT:
        return f"the reply of {known.name}"
    return name_of(entity, timeline)


def group_of(entity: EntityId, timeline: Timeline) -> str:
    """The group of an entity: ``group A``."""
    known = timeline.entities.get(entity)
    group = None if known is None else timeline.groups.get(known.group)
    return "its group" if group is None else f"group {group.letter}"


def listed(names: Iterable[str]) -> str:
    """Several names as one would say them: ``a, b and c``."""
    *others, last = dict.fromkeys(names)
    return f"{', '.join(others)} and {last}" if others else last


def often(count: int, what: str = "times in all") -> str:
    """How often, in brackets; nothing for once."""
    return f" ({count} {what})" if count > 1 else ""


def thread_count(timeline: Timeline) -> int:
    """How many callbacks the executors of a run can run at once."""
    return sum(executor.threads for executor in timeline.executors.values())


def threads_for(entities: Iterable[EntityId], at: Nanoseconds, timeline: Timeline) -> int:
    """How many callbacks the executor can run at once that ran the first of some entities last by ``at``.

    An executor without workers of its own runs all on the one thread that spins it; so does an unknown one.
    """
    for entity in entities:
        for span in timeline.spans_of(entity, Window(0, at + 1))[-1:]:
            thread = timeline.threads.get(span.thread)
            executor = None if thread is None else timeline.executors.get(thread.executor)
            return 1 if executor is None else executor.threads
    return 1


def with_threads(threads: int) -> str:
    """The executor with so many threads, as code would make it."""
    return f"MultiThreadedExecutor(num_threads={threads})"
