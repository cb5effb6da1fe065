"""An engine that keeps contents sends them as they were published, and otherwise runs as without."""

from pathlib import Path
from queue import Queue
from typing import Any

import msgspec
import pytest

from cbtui.engines.session import ProcessSession
from sim.engine.commands import KeepContents
from sim.interfaces import from_cdr, message
from sim.ros.middleware.contents import Contents
from sim.trace.events import AnyEvent, MessageSent, Printed, Published, TopicAppeared, decode, encode
from tests.support.engine_runs import Run, program_setup, run_to_end

CHANGES_WHAT_IT_GETS = """
import rclpy
from rclpy.node import Node
from std_msgs.msg import Int32

class Numbers(Node):
    def __init__(self):
        super().__init__("numbers")
        self.publisher = self.create_publisher(Int32, "n", 10)
        self.create_subscription(Int32, "n", self.change, 10)
        self.create_timer(0.01, self.tick)
        self.number = 0

    def tick(self):
        self.number += 1
        self.publisher.publish(Int32(data=self.number))

    def change(self, msg):
        msg.data = -1

rclpy.init()
rclpy.spin(Numbers())
"""


def run(folder: Path, clock: str, *, contents: bool, robot: bool = False) -> Run:
    path = folder / "node.py"
    path.write_text(CHANGES_WHAT_IT_GETS)
    setup = program_setup(path, 1.0, clock, robot=robot)
    return run_to_end(msgspec.structs.replace(setup, contents=contents))


@pytest.mark.parametrize("clock", ["virtual", "real"])
def test_messages_are_kept_as_they_were_published(tmp_path: Path, clock: str) -> None:
    events = run(tmp_path, clock, contents=True).events
    number: Any = message("std_msgs", "Int32")
    (topic,) = (each for each in events if isinstance(each, TopicAppeared) and each.name == "/n")
    sent = [each for each in events if isinstance(each, MessageSent) and each.topic == topic.topic]
    published = [each for each in events if isinstance(each, Published) and each.topic == "/n"]
    assert [(each.t, each.message) for each in sent] == [(each.t, each.message) for each in published]
    values = [from_cdr(number, each.data or b"").data for each in sent]
    assert values == list(range(1, len(published) + 1))
    assert len(values) > (20 if clock == "virtual" else 2)


def test_what_the_robot_publishes_is_kept_too(tmp_path: Path) -> None:
    events = run(tmp_path, "virtual", contents=True, robot=True).events
    types = {each.name: each.message_type for each in events if isinstance(each, TopicAppeared)}
    assert {"/scan": "sensor_msgs/msg/LaserScan", "/odom": "nav_msgs/msg/Odometry"}.items() <= types.items()


def test_a_run_is_the_same_with_contents_and_without_and_so_are_the_contents(tmp_path: Path) -> None:
    plain, rich, again = (run(tmp_path, "virtual", contents=wanted) for wanted in (False, True, True))
    assert [each for each in rich.events if not isinstance(each, TopicAppeared | MessageSent)] == plain.events
    assert rich.events == again.events


def test_contents_can_be_asked_for_while_a_run_goes_on(tmp_path: Path) -> None:
    path = tmp_path / "node.py"
    path.write_text(CHANGES_WHAT_IT_GETS)
    news: Queue[list[AnyEvent] | str | None] = Queue()
    endless = msgspec.structs.replace(program_setup(path, 60.0), until=None, speed=1.0)
    session = ProcessSession(endless, news.put, news.put)

    def until(kind: type[AnyEvent]) -> list[AnyEvent]:
        """What comes up to the next event of a kind, and with it."""
        events: list[AnyEvent] = []
        while not any(isinstance(event, kind) for event in events):
            batch = news.get(timeout=60)
            assert isinstance(batch, list), batch
            events += batch
        return events

    session.start()
    try:
        assert not any(isinstance(event, MessageSent) for event in until(Published))
        session.send(KeepContents(wanted=True))
        assert any(isinstance(event, TopicAppeared) for event in until(MessageSent))
    finally:
        session.stop()


def test_texts_that_no_encoding_has_are_spelt_out() -> None:
    event = Printed(1, "name: \udc80", error=False)
    for pack in (encode, Contents(wanted=True).pack):
        assert decode(pack([event])) == [Printed(1, "name: \\udc80", error=False)]
