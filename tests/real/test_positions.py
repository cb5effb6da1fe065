"""A run on real rclpy tells at which line each callback is, and what it does there."""

import re
from pathlib import Path

import pytest

from sim.diagnosis import diagnose
from sim.trace.events import Doing
from tests.real import programs

LOCKS = """
import threading

class Tried(Node):
    def __init__(self):
        super().__init__("tried")
        self.lock = threading.Lock()
        group = ReentrantCallbackGroup()
        for callback in (self.keep, self.take, self.enter, self.ask):
            self.create_timer(0.3, callback, callback_group=group)
        self.create_service(SetBool, "switch", self.serve)
        self.client = self.create_client(SetBool, "switch", callback_group=group)

    def keep(self):
        with self.lock:
            time.sleep(0.2)

    def take(self):
        time.sleep(0.05)
        self.lock.acquire()
        self.lock.release()

    def enter(self):
        time.sleep(0.05)
        with self.lock:
            pass

    def ask(self):
        self.client.call(SetBool.Request(data=True))

    def serve(self, request, response):
        time.sleep(0.1)
        return response
"""


COMPUTES = """
class Tried(Node):
    def __init__(self):
        super().__init__("tried")
        self.create_timer(0.3, self.compute)

    def compute(self):
        end = time.monotonic() + 0.1
        while time.monotonic() < end:
            sum(range(20_000))
"""


@programs.needs_ros
@pytest.mark.parametrize("ground", ["model", "ros2"])
def test_the_line_of_a_callback_is_seen(tmp_path: Path, ground: str) -> None:
    executor = "MultiThreadedExecutor(num_threads=7)"
    timeline = programs.run(tmp_path, LOCKS, executor, ground=ground, seconds=1.5).timeline
    seen = {
        (each.frames[-1].function, each.doing, each.call)
        for entity in timeline.entities
        for each in timeline.positions_of(entity, programs.whole(timeline))
    }
    assert {
        ("keep", Doing.SLEEPS, "time.sleep"),
        ("take", Doing.SLEEPS, "time.sleep"),
        ("take", Doing.WAITS, "Lock.acquire"),
        ("enter", Doing.WAITS, "Lock.acquire"),
        ("ask", Doing.CALLS_ROS, "Client.call"),
        ("serve", Doing.SLEEPS, "time.sleep"),
    } <= seen


CROSSED = """
import threading

class Tried(Node):
    def __init__(self):
        super().__init__("tried")
        self.locks = threading.Lock(), threading.Lock()
        for callback in (self.one, self.other):
            self.create_timer(0.2, callback, callback_group=MutuallyExclusiveCallbackGroup())

    def one(self):
        self.take(*self.locks)

    def other(self):
        self.take(*reversed(self.locks))

    def take(self, first, second):
        first.acquire()
        time.sleep(0.2)
        second.acquire()
        second.release()
        first.release()
"""


@programs.needs_ros
@pytest.mark.slow
def test_who_waits_for_a_lock_for_long_is_told_with_the_line(tmp_path: Path) -> None:
    executor = "MultiThreadedExecutor(num_threads=2)"
    timeline = programs.run(tmp_path, CROSSED, executor, seconds=3.0).timeline
    found = next(each for each in diagnose(timeline) if each.rule.id == "waits-for-lock")
    said = found.explained(timeline).what
    assert re.sub(r"one|other|\d+", "_", said) == (
        "_ (tried.py:_) has waited for second for _._ s, and so does _ (tried.py:_)"
    )


@programs.needs_ros
def test_what_computes_is_seen_in_its_loop(tmp_path: Path) -> None:
    timeline = programs.run(tmp_path, COMPUTES, ground="ros2", seconds=1.5).timeline
    found = [
        each
        for entity in timeline.entities
        for each in timeline.positions_of(entity, programs.whole(timeline))
    ]
    assert {each.doing for each in found} == {Doing.COMPUTES}
    loops = {each.loop for each in found}
    assert len(loops) == 1
    first = loops.pop()[1]
    assert {each.frames[-1].line for each in found} <= {first, first + 1}


NEVER_MADE = """
class Tried(Node):
    def __init__(self):
        super().__init__("tried")
        self.create_timer(0.2, self.tick)
        rclpy.spin(self)
        self.create_timer(0.2, self.tick)

    def tick(self):
        time.sleep(0.05)
"""
NEVER_SPUN = """
class Tried(Node):
    def __init__(self):
        super().__init__("tried")
        self.create_timer(0.2, self.tick)
        while True:
            time.sleep(0.1)

    def tick(self):
        pass
"""


@programs.needs_ros
@pytest.mark.slow
@pytest.mark.parametrize("body", [NEVER_MADE, NEVER_SPUN])
def test_a_program_that_never_gets_beyond_init_is_told_of_as_on_the_model(tmp_path: Path, body: str) -> None:
    def told(ground: str) -> set[tuple[str, str, int]]:
        timeline = programs.run(tmp_path, body, ground=ground).timeline
        explained = [(each.rule, each.explained(timeline)) for each in diagnose(timeline)]
        return {
            (rule.id, each.what, each.place.first_line) for rule, each in explained if each.place is not None
        }

    on_model = told("model")
    assert on_model
    assert told("ros2") == on_model


CALLS_ITSELF = """
class Tried(Node):
    def __init__(self):
        super().__init__("tried")
        self.create_service(SetBool, "switch", self.serve)
        self.client = self.create_client(SetBool, "switch")
        self.create_timer(0.3, self.ask)

    def ask(self):
        self.client.call(SetBool.Request(data=True), timeout_sec=8.0)

    def serve(self, request, response):
        return response
"""


@programs.needs_ros
def test_a_call_with_a_timeout_is_told_with_its_end(tmp_path: Path) -> None:
    timeline = programs.run(tmp_path, CALLS_ITSELF, ground="ros2", seconds=1.5).timeline
    (found,) = (each for each in diagnose(timeline) if each.rule.id == "self-made-deadlock")
    [ask] = timeline.calls_begun(programs.entity_named("ask", timeline), programs.whole(timeline))
    assert (found.ends - ask.start) / 1e9 == pytest.approx(8.0, abs=0.3)
    assert not found.explained(timeline).for_ever
