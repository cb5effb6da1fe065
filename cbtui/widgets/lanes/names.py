"""What lanes are called, in as many columns as there are."""

from cbtui.text.callback_names import short_name
from sim.trace.model import EntityInfo, GroupInfo, ThreadInfo

_LEAST_PROGRAM = 3
"""Columns below which nothing is left of a program's name to know it by."""
_BRIEF = 4
"""Letters by which the kinds of groups are still known."""


def short_thread(name: str) -> str:
    """Return a thread's name with the pool's long class name cut to ``Pool``."""
    return name.replace("ThreadPoolExecutor", "Pool", 1)


def thread_name(thread: ThreadInfo, room: int, ellipsis: str) -> str:
    """Return a thread's name in at most ``room`` columns, if any form of it is as short as that.

    The program that it belongs to, of several, gives way in its middle: the end is what tells two apart.
    """
    for name in (thread.name, short_thread(thread.name)):
        if len(name) <= room:
            return name
    program, between, rest = short_thread(thread.name).rpartition(" ")
    for brief in (rest, rest.replace("MainThread", "Main").replace("Pool-", "P")):
        left = room - len(brief) - 1
        if between and left >= min(len(program), _LEAST_PROGRAM):
            return f"{_without_middle(program, left, ellipsis)} {brief}"
    return short_thread(thread.name)


def _without_middle(text: str, room: int, ellipsis: str) -> str:
    if len(text) <= room:
        return text
    before = (room - 1) // 3
    return f"{text[:before]}{ellipsis}{text[len(text) - (room - 1 - before) :]}"


def group_name(group: GroupInfo, room: int) -> str:
    """Return what kind of group one of several callbacks is."""
    whole, brief = _kinds(group)
    return whole if len(whole) <= room else brief


def entity_name(entity: EntityInfo, room: int) -> str:
    """Return the name of a callback of a group of several."""
    return entity.label if len(entity.label) <= room else short_name(entity.label)


def sole_name(entity: EntityInfo, group: GroupInfo, room: int) -> str:
    """Return the name of a group's only callback, after the kind of the group where there is room for it."""
    names = (entity.label, short_name(entity.label))
    for text in (f"{kind} {name}" for kind in _kinds(group) for name in names):
        if len(text) <= room:
            return text
    return short_name(entity.label)


def more_lanes(hidden: int, key: str, room: int) -> str:
    """Say how many lanes are not shown and which key shows them, in as many words as there is room for.

    ``key`` is "" where no key does.
    """
    plain = f"+{hidden} lanes"
    told = (f"{plain}: {key} shows more", f"{plain} {key}", f"+{hidden} {key}") if key else ()
    return next((text for text in told if len(text) <= room), plain)


def _kinds(group: GroupInfo) -> tuple[str, str]:
    """A group's kind, whole and brief."""
    return group.kind.value, group.kind.value[:_BRIEF]
