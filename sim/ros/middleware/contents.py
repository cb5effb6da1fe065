"""The contents of published messages, on their way to the trace."""

from collections.abc import Callable
from typing import Any, cast

import msgspec

from sim.interfaces import Message, definition, to_cdr, type_name
from sim.ros.middleware.type_description import type_hash
from sim.ros.qos.offered import offered_qos_text
from sim.ros.qos.qos import QoSProfile
from sim.trace.events import (
    AnyEvent,
    ContentsLost,
    MessageId,
    MessageSent,
    TopicAppeared,
    TopicId,
    TraceEvent,
    escape_surrogates,
)

_MOST_WAITING = 32_000_000
"""Estimated bytes of messages that may wait to be encoded."""


class _ContentTopic:
    """A topic's number, and the encoded size of its last message in bytes."""

    __slots__ = ("number", "size")

    def __init__(self, number: TopicId) -> None:
        self.number = number
        self.size = 0


class _Content:
    """A message that no longer changes, and its topic. Not a dataclass: msgspec would encode it by itself."""

    __slots__ = ("message", "topic")

    def __init__(self, message: Message, topic: _ContentTopic) -> None:
        self.message = message
        self.topic = topic


class _MessageWaiting(TraceEvent, frozen=True, tag="message"):
    """A ``MessageSent`` whose data is not encoded yet; both have the same encoding."""

    message: MessageId
    topic: TopicId
    data: _Content


class Contents:
    """Makes events with the contents of messages, while ``wanted``.

    On the real clock, encoding would delay the publishing thread, so ``pack`` encodes messages on the thread
    that sends the events. Contents that exceed the queue are dropped and counted. On virtual time
    ``make_room`` is given, which sends the queued events: nothing is dropped, and messages are encoded at
    once, which takes no virtual time and saves a copy.

    ``events`` is called with the host's lock held, ``pack`` on one thread at a time.
    """

    def __init__(self, *, wanted: bool, make_room: Callable[[], None] | None = None) -> None:
        self.wanted = wanted
        self._make_room = make_room
        self._encoder = msgspec.msgpack.Encoder(enc_hook=_encode)
        self._topics: dict[tuple[str, type[Message]], _ContentTopic] = {}
        # Two counters of bytes; each is written by only one thread.
        self._queued = 0
        self._encoded = 0
        self._lost = 0

    @property
    def keeps_messages(self) -> bool:
        """Whether messages are encoded later, so that no callback may change the same object."""
        return self.wanted and self._make_room is None

    def events(
        self, now: int, message: MessageId, topic: str, data: Message, qos: QoSProfile
    ) -> list[AnyEvent]:
        """The events for a publication, besides ``published``; ``qos`` is the publisher's profile."""
        if self._queued - self._encoded > _MOST_WAITING and self._make_room is not None:
            self._make_room()
        if self._queued - self._encoded > _MOST_WAITING:
            self._lost += 1
            return [ContentsLost(now, self._lost)]
        known = self._topics.get((topic, type(data)))
        if known is None:
            known = self._topics[topic, type(data)] = _ContentTopic(len(self._topics) + 1)
            return [
                _appeared(now, known.number, topic, type(data), qos),
                self._sent(now, message, known, data),
            ]
        return [self._sent(now, message, known, data)]

    def _sent(self, now: int, message: MessageId, topic: _ContentTopic, data: Message) -> AnyEvent:
        self._queued += topic.size
        if self._make_room is None:
            return cast("AnyEvent", _MessageWaiting(now, message, topic.number, _Content(data, topic)))
        packed = _cdr(data)
        topic.size = 0 if packed is None else len(packed)
        return MessageSent(now, message, topic.number, packed)

    def pack(self, events: list[AnyEvent]) -> bytes:
        """Encode events as ``sim.trace.events.encode`` does, and the messages in the events of ``events``."""
        queued = self._queued
        try:
            packed = self._encoder.encode(events)
        except UnicodeEncodeError:
            packed = self._encoder.encode(escape_surrogates(events))
        self._encoded = queued
        return packed


def _appeared(now: int, number: TopicId, topic: str, kind: type[Message], qos: QoSProfile) -> TopicAppeared:
    return TopicAppeared(
        now, number, topic, type_name(kind), definition(kind), str(type_hash(kind)), offered_qos_text(qos)
    )


def _encode(content: Any) -> bytes | None:
    packed = _cdr(content.message)
    content.topic.size = 0 if packed is None else len(packed)
    return packed


def _cdr(message: Message) -> bytes | None:
    try:
        return to_cdr(message)
    except Exception:  # noqa: BLE001 -- a program can put any object into a message's list
        return None
