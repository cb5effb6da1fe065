"""Filters of the log: by words, severity and writer."""

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TypeAlias

from cbtui.widgets.log.line import line_of
from sim.trace.events import EntityId, Logged, Printed, Severity, ThreadId
from sim.trace.timeline import Timeline

LogEvent: TypeAlias = Logged | Printed

_LEVELS = list(Severity)
_LEVELS_NAMED = {level.lower(): level for level in _LEVELS} | {"warning": Severity.WARN}
_PART = re.compile(r'(?:[^\s"]|"[^"]*"?)+')
_NAMED = re.compile(r"([a-z]+):(.*)", re.IGNORECASE)
_KNOWN = ("level", "callback", "thread", "group")


class FilterError(ValueError):
    """An invalid filter; the text is a sentence that says why."""


@dataclass(frozen=True, slots=True)
class Filter:
    """Passes lines that contain all ``words``, are severe enough, and were written by a named writer.

    Case is ignored. ``callbacks``, ``threads`` and ``groups`` pass all writers if empty, else those that
    match one of them: a part of the callback's or topic's name, a part of the thread's name, the group's
    letter. A line that was printed instead of logged has no known writer; it is INFO, or ERROR on standard
    error.
    """

    words: tuple[str, ...] = ()
    level: Severity = Severity.DEBUG
    callbacks: tuple[str, ...] = ()
    threads: tuple[str, ...] = ()
    groups: tuple[str, ...] = ()

    @property
    def passes_all(self) -> bool:
        """Whether it passes every line."""
        return self == _EVERYTHING

    def passes(self, event: LogEvent, timeline: Timeline) -> bool:
        """Tell whether it passes a line of the timeline."""
        return (
            _LEVELS.index(_severity(event)) >= _LEVELS.index(self.level)
            and self._has_words(event)
            and self._was_written_by(event, timeline)
        )

    def _has_words(self, event: LogEvent) -> bool:
        if not self.words:
            return True
        line = line_of(event).lower()
        return all(word in line for word in self.words)

    def _was_written_by(self, event: LogEvent, timeline: Timeline) -> bool:
        if not (self.callbacks or self.threads or self.groups):
            return True
        if isinstance(event, Printed):
            return False
        return (
            _is_one_of(self.callbacks, _has_part, _names(event.entity, timeline))
            and _is_one_of(self.threads, _has_part, _thread(event.thread, timeline))
            and _is_one_of(self.groups, str.__eq__, _letter(event.entity, timeline))
        )


_EVERYTHING = Filter()


def filter_of(text: str) -> Filter:
    """Parse a filter: ``words``, ``"words with blanks"`` and ``name:value``.

    Raises:
        FilterError: a name is not one of level, callback, thread and group, or has no value that fits.
    """
    words: list[str] = []
    named: dict[str, list[str]] = {name: [] for name in _KNOWN}
    for part in _parts(text):
        found = _NAMED.fullmatch(part)
        if found is None or not _is_asked_for(found[1], found[2]):
            words.append(_unquoted(part))
        else:
            named[found[1].lower()].append(_value(found[1].lower(), _unquoted(found[2])))
    return Filter(
        tuple(word for word in words if word),
        min((Severity(level) for level in named["level"]), key=_LEVELS.index, default=Severity.DEBUG),
        tuple(named["callback"]),
        tuple(named["thread"]),
        tuple(named["group"]),
    )


def _parts(text: str) -> Iterator[str]:
    return (found[0].lower() for found in _PART.finditer(text))


def _unquoted(part: str) -> str:
    return part.replace('"', "")


def _is_asked_for(name: str, value: str) -> bool:
    """Tell whether a part with a colon is a named filter; ``done:`` and ``http://`` are words."""
    if name in _KNOWN:
        return True
    if value and not value.startswith("/"):
        known = ", ".join(f"{each}:" for each in _KNOWN)
        raise FilterError(f'there is no {name}: to filter by, only {known}, or put it in "quotes"')
    return False


def _value(name: str, value: str) -> str:
    if name == "level":
        return _level(value)
    if not value:
        wanted = "a letter" if name == "group" else "a part of its name"
        example = {"callback": "odom", "thread": "0_1", "group": "A"}[name]
        raise FilterError(f"{name}: wants {wanted}, such as {name}:{example}")
    return value


def _level(value: str) -> str:
    if value not in _LEVELS_NAMED:
        raise FilterError(f"level: wants one of {', '.join(level.lower() for level in _LEVELS)}")
    return _LEVELS_NAMED[value]


def _severity(event: LogEvent) -> Severity:
    if isinstance(event, Printed):
        return Severity.ERROR if event.error else Severity.INFO
    return event.severity


def _is_one_of(wanted: tuple[str, ...], agrees: Callable[[str, str], bool], name: str) -> bool:
    return not wanted or any(agrees(name, each) for each in wanted)


def _has_part(name: str, part: str) -> bool:
    return part in name


def _names(entity: EntityId, timeline: Timeline) -> str:
    """Callback, and topic or service, on separate lines, so that no word matches across both."""
    known = timeline.entities.get(entity)
    return "" if known is None else f"{known.callback}\n{known.name}".lower()


def _thread(thread: ThreadId, timeline: Timeline) -> str:
    known = timeline.threads.get(thread)
    return "" if known is None else known.name.lower()


def _letter(entity: EntityId, timeline: Timeline) -> str:
    known = timeline.entities.get(entity)
    return "" if known is None else timeline.groups[known.group].letter.lower()
