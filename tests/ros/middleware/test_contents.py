"""What messages hold goes on the trace as it was sent: whoever gets them, and however many there are."""

from typing import Any

import pytest

from sim.interfaces import definition, from_cdr, message
from sim.ros.middleware import contents
from sim.ros.middleware.contents import Contents
from sim.ros.middleware.type_description import type_hash
from sim.ros.qos.offered import offered_qos_text
from sim.ros.qos.qos import QoSProfile
from sim.trace.events import AnyEvent, ContentsLost, MessageSent, TopicAppeared, decode

NUMBER: Any = message("std_msgs", "Int32")
TEXT: Any = message("std_msgs", "String")
QOS = QoSProfile(depth=7)


def unpacked(kept: Contents, events: list[AnyEvent]) -> list[AnyEvent]:
    return decode(kept.pack(events))


def test_a_topic_appears_with_its_first_message_and_its_definition() -> None:
    kept = Contents(wanted=True)
    events = unpacked(
        kept, [*kept.events(5, 1, "/n", NUMBER(data=3), QOS), *kept.events(6, 2, "/n", NUMBER(data=4), QOS)]
    )
    assert events == [
        TopicAppeared(
            5,
            1,
            "/n",
            "std_msgs/msg/Int32",
            definition(NUMBER),
            str(type_hash(NUMBER)),
            offered_qos_text(QOS),
        ),
        MessageSent(5, 1, 1, b"\0\1\0\0\3\0\0\0"),
        MessageSent(6, 2, 1, b"\0\1\0\0\4\0\0\0"),
    ]


def test_a_topic_with_two_types_is_two() -> None:
    kept = Contents(wanted=True)
    events = [*kept.events(0, 1, "/n", NUMBER(), QOS), *kept.events(0, 2, "/n", TEXT(data="x"), QOS)]
    topics = [event for event in unpacked(kept, events) if isinstance(event, TopicAppeared)]
    assert [(each.topic, each.message_type) for each in topics] == [
        (1, "std_msgs/msg/Int32"),
        (2, "std_msgs/msg/String"),
    ]


def test_a_message_that_cannot_be_encoded_is_without_contents() -> None:
    kept = Contents(wanted=True)
    *_, sent = unpacked(kept, kept.events(0, 1, "/t", TEXT(data="\ud800"), QOS))
    assert sent == MessageSent(0, 1, 1, None)


def test_what_does_not_fit_is_thrown_away_and_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(contents, "_MOST_WAITING", 20)
    kept = Contents(wanted=True)
    first = kept.events(0, 1, "/n", NUMBER(), QOS)
    kept.pack(first)
    waiting = [event for number in range(2, 7) for event in kept.events(0, number, "/n", NUMBER(), QOS)]
    assert waiting[3:] == [ContentsLost(0, 1), ContentsLost(0, 2)]
    kept.pack(waiting)
    assert isinstance(unpacked(kept, kept.events(0, 8, "/n", NUMBER(), QOS))[0], MessageSent)


def test_where_room_can_be_made_nothing_is_thrown_away(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(contents, "_MOST_WAITING", 20)
    waiting: list[AnyEvent] = []
    sent: list[AnyEvent] = []

    def make_room() -> None:
        sent.extend(unpacked(kept, waiting))
        waiting.clear()

    kept = Contents(wanted=True, make_room=make_room)
    for number in range(50):
        waiting += kept.events(0, number, "/n", NUMBER(data=number), QOS)
    make_room()
    numbers = [from_cdr(NUMBER, each.data) for each in sent if isinstance(each, MessageSent) and each.data]
    assert [each.data for each in numbers] == list(range(50))
