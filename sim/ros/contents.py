"""What published messages hold, on its way to the trace."""

from collections.abc import Callable
from typing import Any, cast

import msgspec

from sim.ros.interfaces import Message, definition, to_cdr, type_name
from sim.trace.events import (
    AnyEvent,
    ContentsLost,
    Event,
    MessageId,
    MessageSent,
    TopicAppeared,
    TopicId,
)

_BOUND = 32_000_000
"""Bytes of messages, as far as can be told, that may wait to be encoded."""


class _Content:
    """A message of a topic that nobody changes any more."""

    __slots__ = ("message", "topic")

    def __init__(self, message: Message, topic: TopicId) -> None:
        self.message = message
        self.topic = topic


class _MessageWaiting(Event, frozen=True, tag="message"):
    """A ``MessageSent`` whose data are not encoded yet: packed, the two are the same."""

    message: MessageId
    topic: TopicId
    data: _Content


class Contents:
    """Turns messages into events with their contents, while ``wanted``.

    On the real clock encoding would hold up the thread that publishes, so it happens in ``pack``, on the
    thread that sends the events; what does not fit meanwhile is thrown away and counted. ``make_room`` is
    given on virtual time: nothing is thrown away, since it has waiting events sent, and messages are encoded
    at once, which costs no virtual time and saves a copy.

    ``events`` is called with the host's lock held, ``pack`` on one thread at a time.
    """

    def __init__(self, *, wanted: bool, make_room: Callable[[], None] | None = None) -> None:
        self.wanted = wanted
        self._make_room = make_room
        self._encoder = msgspec.msgpack.Encoder(enc_hook=self._encode)
        self._topics: dict[tuple[str, type[Message]], TopicId] = {}
        self._sizes: dict[TopicId, int] = {}
        # Two counters, each with a thread of its own that sets it.
        self._taken = 0
        self._packed = 0
        self._lost = 0

    @property
    def keeps_messages(self) -> bool:
        """Whether messages are looked at later, so that nobody may be handed them to change."""
        return self.wanted and self._make_room is None

    def events(self, now: int, message: MessageId, topic: str, data: Message) -> list[AnyEvent]:
        """What goes on the trace besides the publication."""
        if self._taken - self._packed > _BOUND and self._make_room is not None:
            self._make_room()
        if self._taken - self._packed > _BOUND:
            self._lost += 1
            return [ContentsLost(now, self._lost)]
        known = self._topics.get((topic, type(data)))
        appeared = [] if known else [self._appeared(now, topic, type(data))]
        number = known or appeared[0].topic
        content = _Content(data, number)
        if self._make_room is not None:
            sent: AnyEvent = MessageSent(now, message, number, self._encode(content))
        else:
            sent = cast("AnyEvent", _MessageWaiting(now, message, number, content))
        self._taken += self._sizes.get(number, 0)
        return [*appeared, sent]

    def _appeared(self, now: int, topic: str, kind: type[Message]) -> TopicAppeared:
        number = self._topics[topic, kind] = len(self._topics) + 1
        return TopicAppeared(now, number, topic, type_name(kind), definition(kind))

    def pack(self, events: list[AnyEvent]) -> bytes:
        """Do what ``sim.trace.events.encode`` does, for events among which are some of ``events``."""
        taken = self._taken
        packed = self._encoder.encode(events)
        self._packed = taken
        return packed

    def _encode(self, content: Any) -> bytes | None:
        data: bytes | None
        try:
            data = to_cdr(content.message)
        except Exception:  # noqa: BLE001 -- what a program put into a list of a message's can be anything
            data = None
        self._sizes[content.topic] = 0 if data is None else len(data)
        return data
