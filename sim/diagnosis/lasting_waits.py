"""Which callbacks have been where they are for so long that it counts as a wait."""

from collections.abc import Iterator

from sim.trace.events import EntityId, NoticeKind
from sim.trace.model import AWAIT, Nanoseconds, Position, Window
from sim.trace.timeline import Timeline

SETTLES: Nanoseconds = 100_000_000
"""How long a callback must have been at its line, or in its loop, until that counts as a wait."""


def stands(position: Position, timeline: Timeline, at: Nanoseconds) -> bool:
    """Return whether a callback has been at its line, or in the loop around it, for ``SETTLES`` at ``at``.

    Virtual time stands still while a loop computes: then the engine tells that it does not come back.
    """
    if at - position.start >= SETTLES or _stops_time(position, timeline):
        return True
    before = timeline.positions_on(position.thread, Window(max(0, at - SETTLES), at + 1))
    is_here = ((each.entity, each.loop) == (position.entity, position.loop) for each in before)
    return position.loop[0] != "" and before[0].start <= at - SETTLES and all(is_here)


def _stops_time(position: Position, timeline: Timeline) -> bool:
    return any(
        each.kind is NoticeKind.NO_PROGRESS and each.entity == position.entity and each.t >= position.start
        for each in timeline.notices
    )


def lasting_awaits(entity: EntityId, at: Nanoseconds, timeline: Timeline) -> Iterator[Position]:
    """Yield where calls of a callback have been suspended for ``SETTLES`` at ``at``."""
    for each in timeline.positions_of(entity, Window(at, at + 1)):
        if each.call == AWAIT and at - each.start >= SETTLES:
            yield each
