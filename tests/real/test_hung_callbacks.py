"""A callback on real rclpy that waits and does not go on is told as on the model."""

import re
from pathlib import Path

import msgspec
import pytest

from sim.diagnosis import Weight, diagnose
from sim.quantities.nanoseconds import SECOND
from sim.real.hung_callbacks import HungCallbacks
from sim.trace.events import CallbackAt, CallbackEnded, Doing, RunEnding
from tests.real import programs

ENTITY, THREAD = 5, 7
AT = CallbackAt(SECOND, ENTITY, THREAD, Doing.WAITS, "Event.wait", (("/home/node.py", "tick", 12),))


def looked_at(*events: CallbackAt | CallbackEnded | RunEnding, t: int = 3 * SECOND) -> list[str]:
    hung = HungCallbacks()
    for event in events:
        hung.follow(event)
    return [notice.text for notice in hung.look(t)]


def changed(**fields: object) -> CallbackAt:
    return msgspec.structs.replace(AT, **fields)


def test_a_wait_is_told_once_with_its_beginning_and_its_line() -> None:
    hung = HungCallbacks()
    hung.follow(AT)
    hung.follow(changed(t=2 * SECOND))  # the same line, seen again
    assert not [*hung.look(2 * SECOND)]
    [notice] = hung.look(3 * SECOND)
    assert (notice.entity, notice.thread) == (ENTITY, THREAD)
    assert notice.text == (
        "tick has not come back since 1.000 s (node.py:12, in tick): it waits in Event.wait(); its thread "
        "serves nothing else meanwhile"
    )
    assert not [*hung.look(4 * SECOND)]


@pytest.mark.parametrize(
    "events",
    [
        (changed(until=4 * SECOND),),
        (changed(doing=Doing.SLEEPS),),
        (changed(doing=Doing.CALLS_ROS),),
        (changed(call="Lock.acquire"),),
        (AT, CallbackEnded(2 * SECOND, ENTITY, THREAD)),
        (AT, changed(t=2 * SECOND, frames=(("/home/node.py", "tick", 13),))),
        (AT, RunEnding(2 * SECOND, "")),
    ],
    ids=["timeout", "sleeps", "in rclpy", "lock", "over", "went on", "run is over"],
)
def test_what_ends_by_itself_or_has_gone_on_is_not_told(
    events: tuple[CallbackAt | CallbackEnded | RunEnding, ...],
) -> None:
    assert not looked_at(*events)


def test_a_wait_for_a_lock_is_told_if_its_holder_does_not_just_sleep() -> None:
    wait = changed(call="Lock.acquire", lock="self.lock", holder=8)
    keeper = changed(thread=8, entity=6, call="Event.wait", until=9 * SECOND)
    [told] = looked_at(wait, keeper)
    assert "(node.py:12, in tick): it waits for self.lock; " in told
    asleep = msgspec.structs.replace(keeper, doing=Doing.SLEEPS, call="time.sleep")
    assert not looked_at(wait, asleep)
    assert looked_at(wait, msgspec.structs.replace(asleep, loop=("/home/node.py", 12)))


def test_a_lock_that_a_callback_keeps_while_it_awaits_is_told() -> None:
    assert looked_at(changed(call="Lock.acquire", keeper=6))


def test_a_job_that_waits_for_another_one_is_the_advice_while_a_callback_waits_for_a_job() -> None:
    hung = HungCallbacks()
    hung.waits_for_job(THREAD, ("/home/node.py", "plan", 27))
    hung.follow(changed(call="Future.result"))
    [notice] = hung.look(3 * SECOND)
    assert notice.advice.startswith("a job that waits for another job (node.py:27, in plan) keeps a worker")
    assert notice.text.endswith(notice.advice)


CONDITION = """
import threading

class Tried(Node):
    def __init__(self):
        super().__init__("tried")
        self.changed = threading.Condition()
        group = ReentrantCallbackGroup()
        self.create_timer(0.5, self.consume, callback_group=group)
        self.create_timer(0.2, self.produce, callback_group=group)

    def consume(self):
        with self.changed:
            self.changed.wait()

    def produce(self):
        with self.changed:
            pass
"""
EVENT = """
import threading

class Tried(Node):
    def __init__(self):
        super().__init__("tried")
        self.opened = threading.Event()
        self.create_timer(0.5, self.go)
        self.create_timer(1.0, self.open)

    def go(self):
        self.opened.wait()

    def open(self):
        self.opened.set()
"""
JOBS = """
from concurrent.futures import ThreadPoolExecutor

class Tried(Node):
    def __init__(self):
        super().__init__("tried")
        self.pool = ThreadPoolExecutor(max_workers=1)
        self.create_timer(0.5, self.tick)

    def tick(self):
        self.pool.submit(self.plan).result()

    def plan(self):
        self.pool.submit(time.sleep, 0.1).result()
"""


def problems(folder: Path, body: str, executor: str, ground: str) -> list[tuple[str, str, str]]:
    timeline = programs.run(folder, body, executor, ground=ground, seconds=4.0, clock="real").timeline
    found = [each for each in diagnose(timeline) if each.weight_in(timeline) is Weight.PROBLEM]
    said = [(each.rule.id, each.explained(timeline)) for each in found]
    return [(rule, re.sub(r"\d+\.\d+ s", "_ s", each.what), each.cure) for rule, each in said]


@programs.needs_ros
@pytest.mark.slow
@pytest.mark.parametrize(
    ("body", "said"),
    [(CONDITION, "calls self.changed.notify()"), (EVENT, "self.opened.set() in open"), (JOBS, "(tried.py:2")],
    ids=["condition", "event", "jobs"],
)
def test_a_wait_that_nothing_ends_is_told_as_on_the_model(tmp_path: Path, body: str, said: str) -> None:
    executor = "MultiThreadedExecutor(num_threads=2)"
    [on_model] = problems(tmp_path, body, executor, "model")
    assert said in " ".join(on_model)
    assert problems(tmp_path, body, executor, "ros2") == [on_model]
