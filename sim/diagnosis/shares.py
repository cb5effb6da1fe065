"""The shares of time for which callbacks ask that take turns in a group or on a thread."""

from collections.abc import Iterable, Mapping

from sim.diagnosis.cures import Remedy
from sim.diagnosis.words import thread_of, threads_for, who
from sim.quantities.durations import duration
from sim.trace.events import EntityId, EntityKind, GroupKind
from sim.trace.model import EntityInfo, Nanoseconds, Window
from sim.trace.timeline import Timeline

_WORTH_TELLING = 0.02


def asked_by_turns(entity: EntityInfo, window: Window, timeline: Timeline) -> dict[EntityId, float]:
    """Return the share of the time for which each callback asks that takes turns with a timer.

    That is what a timer would take if it came as often as it is due, and so would a subscription that hears
    one; what others took. Empty if they do not take turns, or a call of a timer takes longer than its period.
    """
    thread = thread_of(entity.id, window.end, timeline)
    every: Iterable[EntityInfo] = timeline.entities.values()
    if thread is not None and threads_for([entity.id], window.end, timeline) > 1:
        group = timeline.groups[entity.group]
        every = timeline.group_members(group.id) if group.kind is GroupKind.EXCLUSIVE else ()
        thread = None
    asked: dict[EntityId, float] = {}
    for each in every:
        calls = timeline.spans_of(each.id, window)
        if not calls or (thread is not None and calls[-1].thread != thread.id):
            continue
        took = sum(call.end_at(window.end) - call.start for call in calls)
        beat = beat_of(each, window.end, timeline)
        beats = timeline.calls_of(beat.id, window)
        share = took / beats / beat.period if beat.period and beats else took / window.length
        if (share >= 1 and beat is each) or each.id in timeline.ever_suspended:
            return {}
        if share >= _WORTH_TELLING:
            asked[each.id] = share
    return asked


def beat_of(entity: EntityInfo, at: Nanoseconds, timeline: Timeline) -> EntityInfo:
    """Return the timer that published what a subscription ran for last; else the entity itself."""
    last = (
        timeline.spans_of(entity.id, Window(0, at + 1))[-1:] if entity.kind is EntityKind.SUBSCRIPTION else ()
    )
    sent = next((timeline.publication(each.message) for each in last), None)
    beat = timeline.entities.get(sent.entity) if sent else None
    return beat if beat and beat.period else entity


def what_it_takes(entity: EntityId, share: float, at: Nanoseconds, timeline: Timeline) -> str:
    """Say what a callback asks for at a time: ``left takes 70 ms every 100 ms``."""
    period = beat_of(timeline.entities[entity], at, timeline).period
    how_often = f"{duration(round(share * period))} every {duration(period)}" if period else f"{share:.0%}"
    return f"{who(entity, timeline)} takes {how_often.replace('%', ' %')}"


def room_for(asked: Mapping[EntityId, float], threads: int, timeline: Timeline) -> Remedy:
    """Return groups for the callbacks that take most, until the others have time enough, and threads."""
    left, moved = sum(asked.values()), list[EntityId]()
    for each in sorted(asked, key=asked.__getitem__, reverse=True):
        if left >= 1:
            moved.append(each)
            left -= asked[each]
    groups = [timeline.entities[each].group for each in asked]
    own = (each for each in moved if groups.count(timeline.entities[each].group) > 1)
    return Remedy(tuple(own), len(moved) + 1 if threads <= len(moved) else 0)
