"""Awaits of futures that do not come: since when, of what, and what would complete it."""

from pathlib import Path

from sim.diagnosis.edits.flags import asked_at, awaited_at, event_setters, never_completed
from sim.diagnosis.rule import CodeLocation
from sim.diagnosis.words import listed
from sim.quantities.durations import timestamp
from sim.trace.events import EntityId, EntityKind
from sim.trace.model import AWAIT, Nanoseconds, Window
from sim.trace.timeline import Timeline


def awaits_in_vain(subject: str, place: CodeLocation | None, since: Nanoseconds) -> str:
    """Return a clause on an await of a future that does not come."""
    at = (place.file, place.first_line) if place else ("", 0)
    future, asked = awaited_at(*at), asked_at(*at)
    by = f", for which line {asked} calls a service and which" if asked else ", which"
    awaits = f"{future}{by}" if future else "what"
    return f"{subject} awaits {awaits} has not come so far, since {timestamp(since)}"


def let_complete(place: CodeLocation | None) -> str:
    """Return what to do about the future that is awaited at a place."""
    at = (place.file, place.first_line) if place else ("", 0)
    future, made = never_completed(*at)
    if future:
        nothing = f"nothing in {Path(at[0]).name} completes {future}, which line {made} makes"
        return f"call {future}.set_result() where the await may end: {nothing}"
    if asked := asked_at(*at):
        return f"look why the service that line {asked} calls does not answer"
    setters = event_setters(*at)
    return f"let {listed(setters)} complete it" if setters else "make sure that something completes it"


def awaits_in_vain_since(entity: EntityId, window: Window, timeline: Timeline) -> Nanoseconds | None:
    """When a callback began an await that lasts, by a window's middle, of no reply to its calls."""
    middle = (window.start + window.end) // 2
    last = timeline.positions_of(entity, Window(middle, middle + 1))[-1:]
    asks = any(each.caller == entity for each in timeline.moment(window.end).pending_calls)
    return next((each.start for each in last if each.call == AWAIT and each.end is None and not asks), None)


def waits_for_no_reply(entity: EntityId, timeline: Timeline) -> bool:
    """Whether a callback waits for the reply of a service whose callback ended without one."""
    services = [each for each in timeline.entities.values() if each.kind is EntityKind.SERVICE]
    for call in timeline.moment(timeline.end).pending_calls:
        until = Window(call.sent, timeline.end + 1)
        served = (
            span
            for each in services
            if each.name == call.service
            for span in timeline.spans_of(each.id, until)
        )
        if call.caller == entity and any(span.message == call.id and span.error for span in served):
            return True
    return False
