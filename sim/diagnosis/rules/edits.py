"""The edits that several rules advise."""

from dataclasses import replace

from sim.diagnosis.cures import Remedy
from sim.diagnosis.edits.flags import sleep_in_loop
from sim.diagnosis.edits.polling import (
    go_on_where_set,
    leave_out,
    look_again,
    one_round_a_call,
    step_by_step,
)
from sim.diagnosis.edits.replies import await_reply, decides_on_parameters, go_on_in_done_callback
from sim.diagnosis.edits.spins import spin_together, spins_in_turn
from sim.diagnosis.rule import CodeLocation, by_edit, made_at
from sim.diagnosis.words import must_answer, threads_for, who
from sim.trace.events import EntityId, EntityKind
from sim.trace.timeline import Timeline


def edits_for_reply(place: CodeLocation | None, entity: EntityId, timeline: Timeline) -> tuple[Remedy, ...]:
    """Return edits of a callback that waits for a reply at a place."""
    if place is not None and decides_on_parameters(place.file, place.first_line):
        return ()
    subject, made = who(entity, timeline), made_at(timeline.entities[entity])
    later: tuple[Remedy, ...] = ()
    if not must_answer(entity, timeline):
        later = by_edit(place, "go on in a done-callback of the future", go_on_in_done_callback)
    is_task = timeline.entities[entity].kind is EntityKind.TASK
    if place is None or made is None or made.file != place.file or is_task:
        return later
    words = f"await the reply in an async def {subject}, and give {subject} a callback group of its own"
    return *later, *by_edit(place, words, await_reply, made.first_line)


def edits_for_waiting(place: CodeLocation | None, entity: EntityId, timeline: Timeline) -> tuple[Remedy, ...]:
    """Return edits of a callback that waits at a place for a condition, or is in a loop there."""
    room = beside_others(entity, timeline)
    sleeping = by_edit(place, "sleep in the loop", sleep_in_loop)
    beside = (replace(room, edit=each.edit) for each in sleeping)
    if timeline.entities[entity].kind not in (EntityKind.TIMER, EntityKind.SUBSCRIPTION):
        return tuple(beside)
    return *_returning(place, entity, timeline), *edits_for_steps(place, entity, timeline), *beside


def beside_others(entity: EntityId, timeline: Timeline) -> Remedy:
    """Return what lets others run while a callback does: a group of its own, and a second thread."""
    return Remedy((entity,), 2 if threads_for([entity], timeline.end, timeline) == 1 else 0)


def edits_for_service(place: CodeLocation | None, entity: EntityId, timeline: Timeline) -> tuple[Remedy, ...]:
    """Return edits of a callback that waits at a place for a service."""
    if timeline.entities[entity].kind is not EntityKind.SERVICE:
        return edits_for_waiting(place, entity, timeline)
    words = f"return the response from {who(entity, timeline)} at once if the service is not there"
    return by_edit(place, words, look_again)


def edits_for_steps(place: CodeLocation | None, entity: EntityId, timeline: Timeline) -> tuple[Remedy, ...]:
    """Return edits of a callback in an endless loop at a place, for timers: they are called again."""
    if timeline.entities[entity].kind is not EntityKind.TIMER:
        return ()
    words = f"do one step of the loop at each call of {who(entity, timeline)}"
    return by_edit(place, words, step_by_step, again=True)


def edits_for_rounds(
    place: CodeLocation | None, entity: EntityId, timeline: Timeline, least: int = 0
) -> tuple[Remedy, ...]:
    """Return edits of a timer's callback that takes longer than its period, in a loop at a place.

    If that is not known, ``least`` is the number of rounds that take so long.
    """
    words = f"do one round of the loop at each call of {who(entity, timeline)}"
    return by_edit(place, words, one_round_a_call, least, again=True)


def edits_for_spinning(
    place: CodeLocation | None, entity: EntityId, function: str, timeline: Timeline
) -> tuple[Remedy, ...]:
    """Return edits of a callback that spins at a place by a function without a future."""
    return *_returning(place, entity, timeline), *by_edit(place, f"leave {function}() out", leave_out)


def _returning(place: CodeLocation | None, entity: EntityId, timeline: Timeline) -> tuple[Remedy, ...]:
    subject = who(entity, timeline)
    return (
        *by_edit(place, f"return from {subject}, and go on where what it waits for is set", go_on_where_set),
        *by_edit(place, f"return from {subject}, and look again at its next call", look_again, again=True),
    )


def not_reached(file: str) -> tuple[str, CodeLocation, tuple[Remedy, ...]]:
    """Tell of a file's ``spin()`` in turn: what is wrong, the second one, and the edit."""
    first, second = (CodeLocation(file, line, line) for line in spins_in_turn(file)[:2])
    what = f"the spin() of line {first.first_line} has not returned, so that no later one was reached"
    return what, second, by_edit(first, "spin all nodes by one executor", spin_together)
