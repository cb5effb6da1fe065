"""The names of lanes, shortened to the available columns."""

from collections.abc import Collection

from cbtui.text.callback_names import short_name
from sim.trace.events import EntityKind, GroupKind
from sim.trace.model import EntityInfo, GroupInfo, ThreadInfo
from sim.trace.roster import roster_of
from sim.trace.timeline import Timeline

_LEAST_PROGRAM = 3
"""Columns below which a program's or an action's name cannot be recognised."""
_BRIEF = 4
"""Letters that identify a kind of group."""
_OF_ACTIONS = {"send_goal": "send", "get_result": "result", "cancel_goal": "cancel"}
"""An action's services, by the word in which their names differ."""


def short_thread(name: str) -> str:
    """Return the name of a thread, or a text with several, with the pool's class name cut to ``Pool``."""
    return name.replace("ThreadPoolExecutor", "Pool")


def thread_name(thread: ThreadInfo, room: int, ellipsis: str) -> str:
    """Return a thread's name in at most ``room`` columns, if it can be shortened so far.

    Of several programs, the program's name is shortened in its middle: their ends differ. A function that
    a thread runs, ``Thread-1 (spin)``, may be cut.
    """
    for name in (thread.name, short_thread(thread.name)):
        if len(name) <= room:
            return name
    program, between, rest = short_thread(thread.name).rpartition(" ")
    for brief in (rest, rest.replace("MainThread", "Main").replace("Pool-", "P")):
        left = room - len(brief) - 1
        if between and not rest.startswith("(") and left >= min(len(program), _LEAST_PROGRAM):
            return f"{shortened(program, left, ellipsis)} {brief}"
    return short_thread(thread.name)


def shortened(text: str, room: int, ellipsis: str, names: Collection[str] = ()) -> str:
    """Return one of ``names`` in at most ``room`` columns, so that it stays different from the others.

    A last word stays whole. The rest loses its end, or its middle if another name begins like it: similar
    names differ at an end.
    """
    if len(text) <= room or room < 3:
        return text
    first, between, last = text.rpartition(" ")
    if between and room - len(last) - 1 >= _LEAST_PROGRAM:
        firsts = [name.removesuffix(f" {last}") for name in names if name.endswith(f" {last}")]
        return f"{shortened(first, room - len(last) - 1, ellipsis, firsts)} {last}"
    if sum(name.startswith(text[: room - 1]) for name in names) == 1:
        return text[: room - 1] + ellipsis
    before = (room - 1) // 2
    return f"{text[:before]}{ellipsis}{text[len(text) - (room - 1 - before) :]}"


def service_name(service: str, room: int, ellipsis: str, names: Collection[str] = ()) -> str:
    """Return one of the services ``names``; of an action's, what differs stays: ``fetch cancel``."""
    action, of_action, part = service.partition("/_action/")
    if len(service) <= room or not of_action:
        return shortened(service, room, ellipsis, names)
    action, word = action.removeprefix("/"), _OF_ACTIONS.get(part, part)
    left = room - len(word) - 1
    actions = {name[1:].partition("/_action/")[0] for name in names if of_action in name}
    return f"{shortened(action, left, ellipsis, actions)} {word}" if left >= min(len(action), 3) else word


def group_name(group: GroupInfo, room: int) -> str:
    """Return the kind of a group of several callbacks."""
    full, brief = _kinds(group)
    return full if len(full) <= room else brief


def told_apart(entity: EntityInfo, timeline: Timeline, reply: str) -> str:
    """Return a callback's label; if others have the same one, a name that tells it from them.

    ``reply`` is the sign of a reply, which is what a client takes.
    """
    roster = roster_of(timeline)
    if roster.labels[entity.label] < 2:
        return entity.label
    if entity.kind is EntityKind.SERVICE:
        return entity.name if entity.label in roster.functions else entity.label
    if entity.kind is EntityKind.CLIENT:
        return f"{entity.label} {reply}"
    if entity.kind is EntityKind.WAITABLE and not entity.callback:  # an action's server or client
        return f"{timeline.nodes.get(entity.node, '').rpartition('/')[2]} {entity.label}"
    return entity.function or entity.label


def entity_name(name: str, room: int, ellipsis: str, names: Collection[str] = ()) -> str:
    """Return the name of a callback in a group of several."""
    return name if len(name) <= room else shortened(short_name(name), room, ellipsis, names)


def sole_name(name: str, group: GroupInfo, room: int, ellipsis: str, names: Collection[str] = ()) -> str:
    """Return the name of a group's only callback, behind the group's kind if there is room."""
    for text in (f"{kind} {each}" for kind in _kinds(group) for each in (name, short_name(name))):
        if len(text) <= room:
            return text
    return shortened(short_name(name), room, ellipsis, names)


def more_lanes(hidden: int, key: str, room: int) -> str:
    """Return how many lanes are hidden and the key that shows them, in the longest text that fits.

    ``key`` is "" if there is none.
    """
    plain = f"+{hidden} lane" + "s" * (hidden > 1)
    told = (f"{plain}: {key} shows more", f"{plain} {key}", f"+{hidden} {key}") if key else ()
    return next((text for text in told if len(text) <= room), plain)


def _kinds(group: GroupInfo) -> tuple[str, str]:
    """A group's kind, in full and abbreviated."""
    full = group.kind.value
    return full, full if group.kind is GroupKind.NONE else full[:_BRIEF]
