"""Entities and waits described in words."""

from collections.abc import Sequence
from itertools import islice

from sim.quantities.durations import duration
from sim.trace.events import Doing, EntityId, EntityKind, NodeId, Reason
from sim.trace.model import AWAIT, Call, EntityInfo, ExecutorInfo, Nanoseconds, Position, Queue, Wait, Window
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


def called_by(call: Call, timeline: Timeline) -> str:
    """Who called a service: ``called by timer_callback``."""
    return f"called by {name_of(call.caller, timeline)}" if call.caller else "called from outside"


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


def silent_topics(timeline: Timeline) -> tuple[str, ...]:
    """Return the topics of the program's subscriptions on which no message is known to have come."""
    whole = Window(0, timeline.end + 1)
    first = islice(timeline.entities.values(), _MOST_ENTITIES)
    ends = [each for each in first if each.kind is EntityKind.SUBSCRIPTION]
    heard = (each for each in ends if timeline.calls_of(each.id, whole) or timeline.waits_of(each.id, whole))
    known = {*timeline.names_sent, *(each.name for each in heard)}
    silent = (each.name for each in ends if each.made_at[0] and each.name not in known)
    return tuple(dict.fromkeys(silent))


def nothing_came(silent: Sequence[str]) -> str:
    """Say that nothing came on topics, of which the first are named; empty for none."""
    more = ", …" if len(silent) > _MOST_TOPICS else ""
    return f"nothing has come on {', '.join(silent[:_MOST_TOPICS])}{more}" if silent else ""


def mismatch_of(entity: EntityInfo, queue: Queue, timeline: Timeline, at: Nanoseconds) -> str:
    """Say that a publisher does not match a subscription that has heard nothing: ``QoS mismatch``; or ""."""
    found = timeline.unmatched.get(entity.id)
    if found is None or found.t > at or queue.depth or timeline.calls_of(entity.id, Window(0, at + 1)):
        return ""
    return "type mismatch" if found.policy == "TYPE" else "QoS mismatch"


_MOST_TOPICS = 3
_MOST_ENTITIES = 1000
"""The most entities that are looked at: a window asks again and again."""


def executor_label(timeline: Timeline) -> str:
    """Return the run's executors as code would make them: ``MultiThreadedExecutor(4)``."""
    return " + ".join(map(executor_made, timeline.executors.values()))


def executor_made(executor: ExecutorInfo) -> str:
    """Return one executor as code would make it."""
    return executor.kind if executor.kind in _SINGLE_THREADED else f"{executor.kind}({executor.threads})"
