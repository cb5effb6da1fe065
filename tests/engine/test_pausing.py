"""Time that is stopped and stepped in an engine process, on both clocks: nothing is lost, nothing twice."""

import time
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from queue import Queue

import msgspec
import pytest

from cbtui.engines.session import ProcessSession
from cbtui.runs.setup.lesson_setup import setup_for
from lessons.catalogue import find
from sim.engine.commands import (
    CallService,
    Command,
    CompleteLine,
    KeepContents,
    Pause,
    Resume,
    RunLine,
    RunUntil,
    SetSpeed,
    Step,
)
from sim.engine.setup import RunSetup
from sim.trace.events import (
    AnyEvent,
    CallbackStarted,
    CommandGiven,
    LineCompleted,
    LineEnded,
    Notice,
    Printed,
    RobotMoved,
    RunEnded,
    Severity,
    TimeHalted,
    TimePassed,
)
from tests.support.engine_runs import SECOND, program_setup, run_lesson, run_to_end
from tests.support.steering import without_commands


class Console:
    """An engine driven by a test as the console drives it."""

    def __init__(self, setup: RunSetup) -> None:
        self.events: list[AnyEvent] = []
        self._news: Queue[list[AnyEvent] | str | None] = Queue()
        self._session = ProcessSession(setup, self._news.put, self._news.put)
        self._session.start()

    def give(self, *orders: Command) -> None:
        for order in orders:
            self._session.send(order)

    def until(self, kind: type[AnyEvent], count: int = 1) -> AnyEvent:
        """Take news until ``count`` events of a kind have come; the last of them."""
        while len(found := [event for event in self.events if isinstance(event, kind)]) < count:
            batch = self._news.get(timeout=60)
            assert isinstance(batch, list), batch
            self.events += batch
        return found[count - 1]

    def count(self, kind: type[AnyEvent]) -> int:
        """How many events of a kind have come."""
        return sum(isinstance(event, kind) for event in self.events)

    def to_the_end(self) -> None:
        """Take all news."""
        while isinstance(batch := self._news.get(timeout=60), list):
            self.events += batch

    def stop(self) -> None:
        self._session.stop()


@contextmanager
def console(setup: RunSetup) -> Iterator[Console]:
    found = Console(setup)
    try:
        yield found
    finally:
        found.stop()


@pytest.mark.slow
def test_a_lesson_that_is_paused_stepped_and_hurried_is_the_lesson_that_is_not() -> None:
    setup = msgspec.structs.replace(setup_for(find("split-groups"), speed=1.0), until=12 * SECOND)
    with console(setup) as run:
        for pause in range(4):
            run.until(RobotMoved, 3 + 5 * pause)
            run.give(Pause(), *[Step()] * 5)
            goal = run.until(TimeHalted, 5 * (pause + 1)).t + SECOND
            run.give(Resume() if pause < 3 else RunUntil(goal))
        run.until(TimeHalted, 21)
        run.give(Step())
        halted = run.until(TimeHalted, 22)
        run.give(SetSpeed(None), Resume())
        run.to_the_end()
    assert goal <= halted.t < 12 * SECOND
    plain = run_lesson("split-groups", 12)
    assert without_commands(run.events) == plain.events


def test_a_line_that_is_given_in_the_middle_of_a_moment_waits_for_its_end_and_says_so() -> None:
    with console(setup_for(find("split-groups"), speed=0.1)) as run:
        run.until(RobotMoved)
        run.give(Step(), Step(), Step(), Step())
        run.until(TimeHalted, 4)
        run.give(Step())
        run.until(TimeHalted, 5)
        run.give(KeepContents(wanted=True), RunLine(1, "ros2 node list"), CompleteLine(2, "ros2 no", 7))
        completed = run.until(LineCompleted)
        notice = run.until(Notice)
        assert isinstance(notice, Notice)
        assert notice.text.startswith("time stands in the middle of a moment")
        assert completed.t == notice.t
        assert not [event for event in run.events if isinstance(event, LineEnded)]
        assert len([event for event in run.events if isinstance(event, Notice)]) == 1, "of the person's line"
        run.give(Resume())
        run.until(LineEnded)


def test_a_run_is_stopped_in_the_middle_of_a_moment() -> None:
    with console(setup_for(find("split-groups"), speed=1.0)) as run:
        run.until(RobotMoved)
        run.give(Step(), Step())
        run.until(TimeHalted, 2)
        run.stop()
        run.to_the_end()
    assert isinstance(run.events[-1], RunEnded)
    assert run.events[-1].reason == "it was stopped"


COUNTING = """
import queue, threading, time
import rclpy
from rclpy.executors import MultiThreadedExecutor
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
from std_msgs.msg import Int32
from std_srvs.srv import SetBool

rclpy.init()
node = Node("n")
group = ReentrantCallbackGroup()
publisher = node.create_publisher(Int32, "a", 100)
client = node.create_client(SetBool, "s", callback_group=group)
heard, served, sent, enough = [], [], [], []

def serve(request, response):
    time.sleep(0.005)
    served.append(1)
    return response

def tick():
    if enough and len(heard) >= len(sent):
        timer.cancel()
        print(f"heard {sorted(heard) == sent} served {len(served) == len(sent)}")
        raise SystemExit(0)
    number = len(sent)
    sent.append(number)
    publisher.publish(Int32(data=number))
    time.sleep(0.003)
    client.call(SetBool.Request())

def stop(request, response):
    enough.append(1)
    return response

def hear(message):
    heard.append(message.data)
    time.sleep(0.001)

single = rclpy.callback_groups.MutuallyExclusiveCallbackGroup()
timer = node.create_timer(0.01, tick, single)
node.create_subscription(Int32, "a", hear, 100, callback_group=group)
node.create_service(SetBool, "s", serve, callback_group=group)
node.create_service(SetBool, "stop", stop, callback_group=group)
executor = MultiThreadedExecutor(4)
executor.add_node(node)
executor.spin()
"""


def test_on_the_real_clock_pauses_and_speeds_lose_nothing_and_do_nothing_twice(tmp_path: Path) -> None:
    path = tmp_path / "node.py"
    path.write_text(COUNTING)
    setup = program_setup(path, 3600.0, clock="real")  # which pass twenty times as fast at last
    with console(setup) as run:
        run.until(CallbackStarted, 3)
        for turn in range(15):
            run.give(Pause())
            time.sleep(0.004)
            run.give(SetSpeed((0.5, 2.0, 20.0)[turn % 3]), Resume())
            time.sleep(0.011)
        run.give(CallService("/stop", data=True))
        run.until(Printed)
        run.stop()
        run.to_the_end()
    printed = [event.text for event in run.events if isinstance(event, Printed) and not event.error]
    assert printed == ["heard True served True"]
    times = Counter(event.text for event in run.events if isinstance(event, CommandGiven))
    assert times["pause"] == times["resume"] == 15


def test_time_on_the_real_clock_is_told_while_nothing_happens_but_not_in_a_pause(tmp_path: Path) -> None:
    path = tmp_path / "node.py"
    path.write_text("import time\ntime.sleep(60)")
    with console(program_setup(path, 60.0, clock="real")) as run:
        run.until(TimePassed, 5)
        run.give(Pause())
        paused = run.until(CommandGiven)
        time.sleep(0.5)  # it is how long the pause lasts, and nothing is waited for
        run.give(Resume())
        resumed = run.until(CommandGiven, 2)
        in_pause = run.events[run.events.index(paused) : run.events.index(resumed)]
        assert sum(isinstance(event, TimePassed) for event in in_pause) <= 1
        run.until(TimePassed, run.count(TimePassed) + 5)
    times = [event.t for event in run.events if isinstance(event, TimePassed)]
    assert times == sorted(set(times))


def test_on_the_real_clock_a_pause_stops_timers_and_says_what_it_cannot_stop(tmp_path: Path) -> None:
    path = tmp_path / "node.py"
    path.write_text(TICKING)
    with console(program_setup(path, 60.0, clock="real")) as run:
        run.until(CallbackStarted, 3)
        run.give(Pause())
        notice = run.until(Notice)
        assert isinstance(notice, Notice)
        assert notice.severity is Severity.INFO
        assert notice.text == "time is stopped for whatever waits; a callback that computes goes on"
        time.sleep(0.1)
        run.give(Step(), RunUntil(notice.t + SECOND))
        refused = run.until(Notice, 2)
        assert isinstance(refused, Notice)
        assert refused.text.startswith("the real clock cannot go step by step")
        assert refused.t == notice.t
        halted = run.until(TimeHalted)
        assert halted.t >= notice.t + SECOND
    in_pause = [e for e in run.events if isinstance(e, CallbackStarted) and e.t == notice.t]
    assert len(in_pause) <= 2


def test_on_the_real_clock_a_paused_run_ends_as_by_ctrl_c(tmp_path: Path) -> None:
    path = tmp_path / "node.py"
    path.write_text(
        f"import os, time; os.chdir({str(tmp_path)!r})\nprint('there', flush=True)\n"
        "try:\n    time.sleep(1000)\nfinally:\n    open('cleaned_up', 'w').close()\n"
    )
    with console(program_setup(path, 2000.0, clock="real")) as run:
        run.until(Printed)
        run.give(Pause())
        run.until(CommandGiven)
        run.stop()
    assert (tmp_path / "cleaned_up").exists()


def test_on_the_real_clock_a_run_s_time_is_up_in_its_own_time(tmp_path: Path) -> None:
    path = tmp_path / "node.py"
    path.write_text(TICKING)
    setup = msgspec.structs.replace(program_setup(path, 20.0, clock="real"), speed=100.0)
    run = run_to_end(setup)
    assert run.ending.reason == "its time was up"
    assert run.ending.t >= 20 * SECOND


TICKING = """
import rclpy
from rclpy.node import Node
rclpy.init()
node = Node("n")
def tick():
    pass
node.create_timer(0.02, tick)
rclpy.spin(node)
"""


def test_paced_virtual_time_is_told_while_a_callback_sleeps_but_not_in_a_pause(tmp_path: Path) -> None:
    path = tmp_path / "node.py"
    path.write_text("import time\ntime.sleep(60)")
    with console(msgspec.structs.replace(program_setup(path, 60.0), speed=1.0)) as run:
        run.until(TimePassed, 5)
        run.give(Pause())
        paused = run.until(CommandGiven)
        time.sleep(0.5)  # it is how long the pause lasts, and nothing is waited for
        run.give(Resume())
        resumed = run.until(CommandGiven, 2)
        in_pause = run.events[run.events.index(paused) : run.events.index(resumed)]
        assert not any(isinstance(event, TimePassed) for event in in_pause)
        last = run.until(TimePassed, run.count(TimePassed) + 5)
    times = [event.t for event in run.events if isinstance(event, TimePassed)]
    assert times == sorted(set(times))
    assert times[4] <= paused.t < last.t < 60 * SECOND
