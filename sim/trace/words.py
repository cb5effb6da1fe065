"""How things of a run are called in a sentence."""

from sim.trace.events import EntityId, Reason
from sim.trace.model import Entity, Wait
from sim.trace.timeline import Timeline


def spoken_name(entity: Entity) -> str:
    """The function a person wrote, else the topic or service, else what kind of thing it is."""
    return entity.callback or entity.name or entity.kind.value


def why_waiting(wait: Wait, timeline: Timeline) -> str:
    """The reason of a wait in words: ``group A held by timer_callback``."""
    if wait.reason is not Reason.GROUP_HELD:
        return wait.reason.value
    waiting = timeline.entities.get(wait.entity)
    group = None if waiting is None else timeline.groups.get(waiting.group)
    what = "its group" if group is None else f"group {group.letter}"
    return f"{what} held by {name_of(wait.holder, timeline)}"


def name_of(entity: EntityId, timeline: Timeline) -> str:
    """The spoken name of an entity by its id."""
    known = timeline.entities.get(entity)
    return "another callback" if known is None else spoken_name(known)
