"""Entities and waits described in words."""

from sim.quantities.durations import duration
from sim.trace.events import Doing, EntityId, NodeId, Reason
from sim.trace.model import AWAIT, Position, Wait, Window
from sim.trace.participants import Participants
from sim.trace.timeline import Timeline

_SINGLE_THREADED = ("SingleThreadedExecutor", "EventsExecutor")


def why_waiting(wait: Wait, timeline: Timeline | Participants) -> str:
    """The reason of a wait as text: ``group A held by timer_callback``."""
    if wait.reason is not Reason.GROUP_HELD:
        return wait.reason.value
    waiting = timeline.entities.get(wait.entity)
    group = None if waiting is None else timeline.groups.get(waiting.group)
    what = "its group" if group is None else f"group {group.letter}"
    return f"{what} held by {name_of(wait.holder, timeline)}"


def doing_of(position: Position) -> str:
    """What a callback does at its line: ``sleeps``, ``waits for self.lock``, ``waits in Client.call()``."""
    match position.doing:
        case Doing.WAITS if position.call == AWAIT:
            return "awaits"
        case Doing.COMPUTES | Doing.SLEEPS:
            return position.doing.value
        case Doing.READS:
            return "waits for the keyboard"
        case Doing.WAITS if position.waits_for_lock:
            return f"waits for {position.lock or 'a lock'}"
    return f"{'waits ' if position.doing is Doing.WAITS else ''}in {position.call}()"


def name_of(entity: EntityId, timeline: Timeline | Participants) -> str:
    """The name of an entity in a sentence."""
    known = timeline.entities.get(entity)
    return "another callback" if known is None else known.spoken_name


def node_name(node: NodeId, timeline: Timeline) -> str:
    """The name of a node; of several with one name, which of them in order of appearance."""
    name = timeline.nodes.get(node, "")
    alike = [each for each, other in timeline.nodes.items() if other == name]
    if len(alike) < 2:
        return name
    place = alike.index(node)
    return f"the {_ORDINALS[place] if place < len(_ORDINALS) else f'{place + 1}th'} {name}"


_ORDINALS = ("first", "second", "third")


def waiting_name(entity: EntityId, during: Window, timeline: Timeline) -> str:
    """The name of what waits, in a sentence; of an action's server with what it is asked by the end.

    A request that came later than the wait began is told with the time between.
    """
    known, name = timeline.entities.get(entity), name_of(entity, timeline)
    action, _, end = ("" if known is None else known.name).partition(" ")
    pending = timeline.calls_within(Window(during.end - 1, during.end)) if end == "server" else ()
    for part, words in _ASKED.items():
        for call in pending:
            if call.service == f"{action}/_action/{part}":
                own = duration(during.end - call.sent)
                after = (
                    "" if own == duration(during.length) else f" after {duration(call.sent - during.start)}"
                )
                return f"{name} ({words}{after})"
    return name


_ASKED = {
    "cancel_goal": "asked to cancel",
    "send_goal": "asked for a goal",
    "get_result": "asked for the result",
}
"""What an action's server is asked, by the last part of the service's name; what matters most first."""


def executor_label(timeline: Timeline) -> str:
    """Return the run's executors as code would make them: ``MultiThreadedExecutor(4)``."""
    return " + ".join(
        executor.kind if executor.kind in _SINGLE_THREADED else f"{executor.kind}({executor.threads})"
        for executor in timeline.executors.values()
    )
