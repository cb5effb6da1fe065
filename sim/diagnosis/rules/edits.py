"""The edits that several rules advise."""

from sim.diagnosis.cures import Remedy
from sim.diagnosis.edits.polling import look_again
from sim.diagnosis.edits.replies import await_reply, go_on_in_done_callback
from sim.diagnosis.rule import CodeLocation, by_edit
from sim.diagnosis.words import who
from sim.trace.events import EntityId, EntityKind
from sim.trace.timeline import Timeline


def edits_for_reply(place: CodeLocation | None, entity: EntityId, timeline: Timeline) -> tuple[Remedy, ...]:
    """Edits of a callback that waits for a reply at a place."""
    subject = who(entity, timeline)
    return (
        *by_edit(place, "go on in a done-callback of the future", go_on_in_done_callback),
        *by_edit(place, f"await the reply in an async def {subject}", await_reply, own_groups=(entity,)),
    )


def edits_for_waiting(place: CodeLocation | None, entity: EntityId, timeline: Timeline) -> tuple[Remedy, ...]:
    """Edits of a timer's callback that waits at a place for something to come true."""
    if timeline.entities[entity].kind is not EntityKind.TIMER:
        return ()
    return by_edit(place, f"return from {who(entity, timeline)}, and look again at its next call", look_again)
