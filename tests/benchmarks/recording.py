"""What recording costs, and how long it takes to open what was recorded."""

import atexit
import time
from collections.abc import Callable
from functools import lru_cache
from itertools import islice
from pathlib import Path
from queue import Queue
from tempfile import TemporaryDirectory
from typing import Any

import msgspec

from cbtui.engines.session import ProcessSession
from cbtui.runs.setup.lesson_setup import RunRequest, setup_for
from lessons.catalogue import find
from sim.engine.setup import RobotUse, RunSetup
from sim.interfaces import to_cdr
from sim.recording import RecordingMetadata, RecordingWriter, RunSnapshot, read
from sim.trace.events import (
    AnyEvent,
    CallbackEnded,
    CallbackStarted,
    EntityReady,
    MessageSent,
    Published,
    RunStarted,
    TopicAppeared,
)
from sim.trace.timeline import Timeline

_RATE = 100
_PERIOD = 1_000_000_000 // _RATE

_LESSON = "split-groups"
_PUBLISHES = """
import rclpy
from rclpy.node import Node
from std_msgs.msg import Int32

class Numbers(Node):
    def __init__(self):
        super().__init__("numbers")
        self.publisher = self.create_publisher(Int32, "number", 10)
        self.create_subscription(Int32, "number", self.hear, 10)
        self.create_timer(0.01, self.tick)
        self.number = 0

    def tick(self):
        self.number += 1
        self.publisher.publish(Int32(data=self.number))

    def hear(self, msg):
        pass

rclpy.init()
rclpy.spin(Numbers())
"""


def _tick(t: int, number: int) -> list[AnyEvent]:
    """A timer's callback publishes, and a subscription gets it."""
    return [
        EntityReady(t, 2, 1, 0),
        CallbackStarted(t, 2, 1, 0, 0, 0),
        Published(t, number, "/n", 1, 2),
        MessageSent(t, number, 1, b"\0\1\0\0\1\0\0\0"),
        EntityReady(t, 1, 1, number),
        CallbackEnded(t, 2, 1),
        CallbackStarted(t, 1, 1, number, 0, 0),
        CallbackEnded(t, 1, 1),
    ]


def _record(path: Path, seconds: int) -> float:
    """Record so many seconds of a 100 Hz lesson; returns the seconds that an event took."""
    recorder = RecordingWriter(path, RecordingMetadata(title="hundred"))
    recorder.take([RunStarted(0, "hundred", "virtual", 0)])
    recorder.take([TopicAppeared(0, 1, "/n", "std_msgs/msg/Int32", "int32 data\n")])
    took, events = 0.0, 0
    for second in range(seconds):
        # A live run sends a batch every 10 ms.
        batches = [_tick(tick * _PERIOD, tick) for tick in range(second * _RATE, (second + 1) * _RATE)]
        began = time.perf_counter()
        for batch in batches:
            recorder.take(batch)
        took += time.perf_counter() - began
        events += sum(map(len, batches))
    recorder.close()
    return took / events


def event(calls: int) -> float:
    """The seconds that recording an event of a live 100 Hz lesson takes."""
    with TemporaryDirectory() as folder:
        return _record(Path(folder) / "run.mcap", max(1, calls // 100))


def slowing(calls: int) -> float:
    """The share by which recording slows down so many seconds of a lesson that runs as fast as it can."""
    return _share(setup_for(find(_LESSON), speed=None), calls)


def slowing_publisher(calls: int) -> float:
    """The same for a node that does nothing but publish numbers and hear them."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "node.py"
        path.write_text(_PUBLISHES)
        setup = RunRequest(files=[path]).setup()
        return _share(msgspec.structs.replace(setup, clock="virtual", robot=RobotUse.NEVER), calls)


def _share(setup: RunSetup, seconds: int) -> float:
    """Run with and without recording, one right after the other; a machine differs from minute to minute."""
    plain = msgspec.structs.replace(setup, until=seconds * 1_000_000_000)
    recorded = msgspec.structs.replace(plain, contents=True)
    with TemporaryDirectory() as folder:
        recorder = RecordingWriter(Path(folder) / "run.mcap", RecordingMetadata(title="hundred"))
        timelines = Timeline(), Timeline()

        def take(events: list[AnyEvent]) -> None:
            recorder.take(events)
            timelines[1].extend(events)

        without = _run(plain, timelines[0].extend)
        share = _run(recorded, take) / without - 1
        recorder.close()
    return share


def following(calls: int) -> float:
    """The seconds that an event of a run takes of which nothing is recorded yet."""
    ticks = range(max(1, calls // 8))
    batches = [_tick(tick * _PERIOD, tick) for tick in ticks]
    snapshot = RunSnapshot()
    began = time.perf_counter()
    for batch in batches:
        snapshot.take(batch)
    return (time.perf_counter() - began) / (8 * len(batches))


def encoding(message: Any, calls: int) -> float:
    """The seconds that making CDR of a message takes."""
    to_cdr(message)
    return _seconds(lambda: [to_cdr(message) for _ in range(calls)]) / calls


def _run(setup: RunSetup, take: Callable[[list[AnyEvent]], object]) -> float:
    """Run an engine to its end; returns the seconds from its first events to its last."""
    news: Queue[list[AnyEvent] | str | None] = Queue(64)
    session = ProcessSession(setup, news.put, news.put)
    session.start()
    batch = news.get()
    began = time.perf_counter()
    while isinstance(batch, list):
        take(batch)
        batch = news.get()
    session.stop()
    return time.perf_counter() - began


def _seconds(step: Callable[[], object]) -> float:
    began = time.perf_counter()
    step()
    return time.perf_counter() - began


@lru_cache(maxsize=2)
def _recorded(seconds: int) -> Path:
    folder = TemporaryDirectory()
    atexit.register(folder.cleanup)
    path = Path(folder.name) / "run.mcap"
    _record(path, seconds)
    return path


def opening(calls: int) -> float:
    """The seconds until the first events of a recording of so many seconds are there."""
    path = _recorded(calls)
    return _seconds(lambda: list(islice(read(path).batches(), 100)))


def reading(calls: int) -> float:
    """The seconds until all events of a recording of so many seconds are there."""
    path = _recorded(calls)
    return _seconds(lambda: sum(map(len, read(path).batches())))
