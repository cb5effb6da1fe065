"""Events as JSON, one object a line, with names instead of ids: what ``--events`` writes.

Which fields a line has follows from the event's class; ``sim/trace/EVENTS.md`` lists them.
"""

from collections.abc import Callable, Iterable, Iterator
from functools import cache
from typing import Any, NamedTuple

import msgspec

from sim.trace import events as ev
from sim.trace.events import (
    AnyEvent,
    EntityId,
    GroupId,
    JsonForm,
    JsonObject,
    NodeId,
    ProcessId,
    Shown,
    ThreadId,
    TopicId,
)
from sim.trace.participants import Participants

ROBOT = "robot"
"""The node of the robot's driver, which the learner's program does not contain."""

_FIRST = (
    *("process", "program", "node", "callback", "kind", "entity", "group", "group_type"),
    *("thread", "reason", "held_by", "depth", "period"),
)
"""Fields that come first in a line, in this order; an event's own fields follow in the order of its class."""
_LAST = ("message_id", "size", "severity")
"""Fields that come last in a line, in this order."""


class JsonField(NamedTuple):
    """An attribute of an event as one field of its line, or several; names with ``?`` may be missing."""

    attribute: str
    name: str
    names: tuple[str, ...]
    form: JsonForm
    optional: bool


@cache
def json_fields(kind: type[AnyEvent]) -> tuple[JsonField, ...]:
    """The fields of an event's line behind ``t`` and ``event``, in their order."""
    fields = [_json_field(field.name, field.type) for field in msgspec.structs.fields(kind)[1:]]
    return tuple(sorted((field for field in fields if field is not None), key=_rank))


def _json_field(attribute: str, annotated: Any) -> JsonField | None:
    marks = getattr(annotated, "__metadata__", ())
    if Shown.NEVER in marks:
        return None
    form = next((mark for mark in marks if isinstance(mark, JsonForm)), JsonForm())
    optional = Shown.IF_ANY in marks
    names = form.names.split() or [attribute]
    told = tuple(f"{name}?" if optional else name for name in names)
    return JsonField(attribute, names[0].rstrip("?"), told, form, optional)


def _rank(field: JsonField) -> int:
    if field.name in _FIRST:
        return _FIRST.index(field.name) - len(_FIRST)
    return _LAST.index(field.name) + 1 if field.name in _LAST else 0


class _RunNames:
    """Implements ``IdNames`` for a run's events."""

    def __init__(self) -> None:
        self._participants = Participants()
        self._entities: dict[EntityId, JsonObject] = {}
        self._topics: dict[TopicId, str] = {}
        self._take: dict[type[AnyEvent], Callable[[Any], object]] = {
            ev.ProcessAppeared: self._participants.add_process,
            ev.ThreadAppeared: self._participants.add_thread,
            ev.NodeAppeared: self._participants.add_node,
            ev.GroupAppeared: self._participants.add_group,
            ev.EntityAppeared: self._add_entity,
            ev.TopicAppeared: self._add_topic,
        }

    def take(self, event: AnyEvent) -> None:
        add = self._take.get(event.__class__)
        if add is not None:
            add(event)

    def _add_entity(self, event: ev.EntityAppeared) -> None:
        entity = self._participants.add_entity(event)
        self._entities[event.entity] = {
            "node": self.node(entity.node),
            **({"callback": entity.callback} if entity.callback else {}),
            "kind": entity.kind,
            "entity": entity.name or entity.spoken_name,
            **self.group(entity.group),
        }

    def _add_topic(self, event: ev.TopicAppeared) -> None:
        self._topics[event.topic] = event.name

    def process(self, process: ProcessId) -> str | None:
        return self._participants.processes.get(process)

    def node(self, node: NodeId) -> str:
        return self._participants.nodes.get(node, ROBOT if node == 0 else f"node {node}")

    def thread(self, thread: ThreadId) -> str:
        known = self._participants.threads.get(thread)
        return f"thread {thread}" if known is None else known.name

    def topic(self, topic: TopicId) -> str:
        return self._topics.get(topic, f"topic {topic}")

    def callback(self, entity: EntityId) -> str | None:
        known = self._participants.entities.get(entity)
        return None if known is None else known.spoken_name

    def entity(self, entity: EntityId) -> JsonObject:
        return self._entities.get(entity, {})

    def group(self, group: GroupId) -> JsonObject:
        known = self._participants.groups.get(group)
        return {} if known is None else {"group": known.letter, "group_type": known.kind}


class JsonLines:
    """Turns events, fed in order, into lines of JSON.

    Every line has ``t`` (seconds) and ``event`` first; then come those fields that apply, always in the same
    order. Fields without a value are left out; infinite numbers and NaN become null. Not thread-safe.
    """

    def __init__(self) -> None:
        self._names = _RunNames()
        self._encode = msgspec.json.Encoder().encode

    def lines(self, events: Iterable[AnyEvent]) -> Iterator[bytes]:
        """One line for each event but ``TimePassed``, ended by a newline."""
        for event in events:
            if event.__class__ is not ev.TimePassed:
                self._names.take(event)
                yield self._encode(self._line(event)) + b"\n"

    def _line(self, event: AnyEvent) -> JsonObject:
        kind = event.__class__
        line: JsonObject = {"t": event.t / 1e9, "event": kind.__struct_config__.tag}
        for attribute, name, _, form, optional in json_fields(kind):
            value = getattr(event, attribute)
            if optional and not value:
                continue
            if form.look_up is not None:
                value = form.look_up(self._names, value)
            elif form.convert is not None:
                value = form.convert(value)
            if value.__class__ is dict:
                line.update(value)
            elif value is not None:
                line[name] = value
        return line
