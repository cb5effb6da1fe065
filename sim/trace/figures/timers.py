"""When timers are due: one answer for the factory's belts and for the narrator."""

from dataclasses import dataclass
from itertools import islice

from sim.trace.events import EntityId, EntityKind, TimerCancelled
from sim.trace.model import Moment, Nanoseconds, Window
from sim.trace.timeline import Timeline


@dataclass(frozen=True, slots=True)
class TimerTick:
    """A timer's time: its next due time, or since when it is due, and the lateness of its last call.

    ``due`` is None if it is unknown.
    """

    due: Nanoseconds | None
    late: Nanoseconds
    is_cancelled: bool = False


_EXAMINED = 100
"""Of very many timers only the first are asked whether they are due."""


def just_due(moment: Moment, timeline: Timeline) -> list[EntityId]:
    """Return the timers that are due at this very moment, and whose calls have not begun."""
    timers = (each.id for each in timeline.entities.values() if each.kind is EntityKind.TIMER)
    free = islice((timer for timer in timers if timer not in moment.waiting), _EXAMINED)
    return [timer for timer in free if tick_of(timer, moment.at, timeline).due == moment.at]


def tick_of(entity: EntityId, at: Nanoseconds, timeline: Timeline) -> TimerTick:
    """Compute a timer's next due time from its last call, as rcl does: missed ticks are dropped."""
    if waits := timeline.moment(at).waiting.get(entity):
        return TimerTick(waits.since, 0)
    timer, ended = timeline.entities[entity], timeline.ended
    spans = timeline.spans_of(entity, Window(at - 2 * timer.period, at + 1))
    begun = spans[-1].start if spans else 0
    cancel = timeline.cancel_since(entity, begun, at)
    if isinstance(cancel, TimerCancelled):
        return TimerTick(None, 0, is_cancelled=True)
    late = spans[-1].age if spans else 0
    due = begun - late + timer.period if spans else timer.first_due if not timeline.begun else None
    due = due if cancel is None else cancel.t + timer.period
    is_over = ended is not None and at >= ended.t and not ended.time_was_up
    if due is None or is_over or timer.period <= 0:
        return TimerTick(None, late)
    if due < begun:
        due += (1 + (begun - due) // timer.period) * timer.period
    return TimerTick(due if due >= at else None, late)
