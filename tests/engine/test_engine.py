"""The engine process: how runs end, what programs may do wrong, and that nothing stays behind."""

import multiprocessing
import os
import signal
from pathlib import Path
from queue import Queue

import msgspec
import pytest

from cbtui.engines.session import ProcessSession
from cbtui.runs.setup.lesson_setup import setup_for
from lessons.catalogue import find
from sim.engine.commands import CallService, Pause, ResetWorld, Resume, SetSpeed
from sim.engine.setup import TimedInput
from sim.trace.events import (
    AnyEvent,
    CommandGiven,
    Notice,
    Printed,
    RobotMoved,
    RunEnded,
    ServiceReplied,
    VelocityCommanded,
)
from tests.support.daily import first_daily, first_row_daily
from tests.support.engine_runs import SECOND, program_setup, run_lesson, run_program, run_to_end

SPIN = """
import rclpy
from rclpy.node import Node
rclpy.init()
node = Node("plain")
{body}
rclpy.spin(node)
"""


@pytest.mark.slow
@pytest.mark.usefixtures("fresh_engines")
@pytest.mark.parametrize("lesson", first_daily("reentrant-2-threads", "split-groups"))
def test_the_same_run_twice_gives_the_same_events(lesson: str) -> None:
    once = run_lesson(lesson, 15, 2.55, 4.0)
    again = run_lesson.__wrapped__(lesson, 15, 2.55, 4.0)
    assert len(once.events) > 1000
    assert once.events == again.events


def test_a_run_ends_when_its_time_is_up(tmp_path: Path) -> None:
    run = run_program(tmp_path, SPIN.format(body="node.create_timer(1.0, lambda: None)"), seconds=3.5)
    assert run.loss is None
    assert run.ending == RunEnded(
        round(3.5 * SECOND), "its time was up", failed=False, time_was_up=True, error=""
    )


def test_a_robot_that_cannot_be_there_from_the_beginning_is_told_of_with_what_to_do(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "pybullet.py").write_text("raise ImportError('no such thing')")
    monkeypatch.syspath_prepend(tmp_path)
    run = run_program(tmp_path, "", robot=True)
    assert run.loss is None
    assert run.ending.failed
    assert run.ending.reason.startswith("PyBullet cannot be imported by this Python")


def test_an_error_of_the_engines_own_is_told_with_its_place(tmp_path: Path) -> None:
    path = tmp_path / "node.py"
    path.write_text("")
    setup = msgspec.structs.replace(program_setup(path, 1.0), inputs=(TimedInput(0, "no input"),))
    run = run_to_end(setup)
    assert run.loss is None
    assert run.ending.failed
    assert run.ending.reason.startswith("the engine failed: DecodeError: JSON is malformed")
    assert "(commands.py:" in run.ending.reason


def test_a_sleeping_program_is_ended_like_by_ctrl_c(tmp_path: Path) -> None:
    source = """
import time
try:
    time.sleep(100)
finally:
    open("cleaned_up", "w").close()
"""
    setup = program_setup(tmp_path / "node.py", 2.0)
    (tmp_path / "node.py").write_text(f"import os; os.chdir({str(tmp_path)!r})\n{source}")
    run = run_to_end(setup)
    assert run.ending.t == 2 * SECOND
    assert (tmp_path / "cleaned_up").exists()


def test_a_program_that_returns_ends_its_run(tmp_path: Path) -> None:
    run = run_program(tmp_path, "import time\ntime.sleep(1.5)\nprint('done')")
    assert run.ending == RunEnded(round(1.5 * SECOND), "the program returned", failed=False, error="")
    assert [event.text for event in run.events if isinstance(event, Printed)] == ["done"]


def test_threads_that_a_program_leaves_are_waited_for(tmp_path: Path) -> None:
    source = "import threading, time\nthreading.Thread(target=lambda: (time.sleep(2), print('late'))).start()"
    run = run_program(tmp_path, source)
    assert [event.text for event in run.events if isinstance(event, Printed)] == ["late"]
    assert run.ending.t == 2 * SECOND


@pytest.mark.parametrize(
    ("source", "sentence"),
    first_row_daily(
        (
            "x = 1\nraise ValueError('no such robot')",
            "node.py:2: the program raised ValueError: no such robot",
        ),
        ("def broken(:\n    pass", "node.py:1: invalid syntax"),
        ("import sys\nsys.exit(3)", "the program ended with exit code 3"),
        ("import sys\nsys.exit('no map')", "the program ended: no map"),
        ("import nonsense_msgs.msg", "node.py:1: the program raised ModuleNotFoundError: No module named"),
        (
            "import rclpy\nfrom rclpy.node import Node\nNode('early')",
            "node.py:3: the program raised NotInitializedException",
        ),
    ),
)
def test_a_program_that_fails_is_told_of_in_one_sentence(tmp_path: Path, source: str, sentence: str) -> None:
    run = run_program(tmp_path, source)
    assert run.loss is None
    assert run.ending.failed
    assert run.ending.reason.startswith(sentence)


def test_an_exception_in_a_callback_names_its_line(tmp_path: Path) -> None:
    body = "def tick():\n    [][3]\nnode.create_timer(1.0, tick)"
    run = run_program(tmp_path, SPIN.format(body=body))
    assert run.ending.reason == "node.py:7: the program raised IndexError: list index out of range"
    assert run.ending.t == SECOND


def test_a_program_that_leaves_the_process_is_a_lost_engine(tmp_path: Path) -> None:
    run = run_program(tmp_path, "import os\nos._exit(7)")
    assert (
        run.loss == "the program ended its process by os._exit(), with exit code 7 (node.py:2, in <module>)"
    )


def test_printing_reaches_the_trace_line_by_line(tmp_path: Path) -> None:
    source = "import sys\nprint('a', end='')\nprint('b')\nsys.stderr.write('c\\nd')"
    run = run_program(tmp_path, source)
    printed = [(event.text, event.error) for event in run.events if isinstance(event, Printed)]
    assert printed == [("ab", False), ("c", True), ("d", True)]


def test_velocities_that_are_no_numbers_are_ignored_and_told_of_once_with_their_place(tmp_path: Path) -> None:
    body = """
from geometry_msgs.msg import Twist
pub = node.create_publisher(Twist, "cmd_vel", 10)
def drive():
    cmd = Twist()
    cmd.linear.x = float("nan")
    pub.publish(cmd)
    cmd.linear.x = 5.0
    pub.publish(cmd)
node.create_timer(1.0, drive)
"""
    run = run_program(tmp_path, SPIN.format(body=body), seconds=3.5, robot=True)
    (notice,) = (event.text for event in run.events if isinstance(event, Notice))
    assert notice.startswith(
        "the robot ignores velocities that are no numbers (node.py:12, in drive): linear"
    )
    (warning,) = (line.text for line in run.timeline.logs)
    assert "linear.x=nan" in warning
    assert {event.linear for event in run.events if isinstance(event, VelocityCommanded)} == {0.22}


class _Console:
    """A session driven by a test as the console drives it."""

    def __init__(self, lesson: str, speed: float | None = 1.0) -> None:
        self.events: list[AnyEvent] = []
        self._news: Queue[list[AnyEvent] | str | None] = Queue()
        self.session = ProcessSession(setup_for(find(lesson), speed=speed), self._news.put, self._news.put)
        self.session.start()

    def until(self, kind: type[AnyEvent], count: int = 1) -> AnyEvent:
        """Take news until an event of a kind has come ``count`` times; that event."""
        found = [event for event in self.events if isinstance(event, kind)]
        while len(found) < count:
            batch = self._news.get(timeout=60)
            assert isinstance(batch, list), batch
            self.events += batch
            found += [event for event in batch if isinstance(event, kind)]
        return found[count - 1]

    def end(self) -> str | None:
        """Take news until the engine is gone; what was said of it."""
        while isinstance(batch := self._news.get(timeout=60), list):
            self.events += batch
        return batch


@pytest.mark.usefixtures("fresh_engines")
def test_a_killed_engine_is_noticed_and_named() -> None:
    console = _Console("single-thread")
    console.until(RobotMoved)
    [engine] = multiprocessing.active_children()
    assert engine.pid is not None
    os.kill(engine.pid, signal.SIGKILL)
    assert console.end() == "the engine was killed by signal 9"
    console.session.stop()
    assert not multiprocessing.active_children()


@pytest.mark.usefixtures("fresh_engines")
def test_stopping_ends_the_process_and_may_be_repeated() -> None:
    console = _Console("exclusive-2-threads")
    console.until(RobotMoved)
    console.session.stop()
    console.session.stop()
    assert console.end() is None
    assert not multiprocessing.active_children()
    assert isinstance(console.events[-1], RunEnded)


def test_a_call_takes_effect_at_the_moment_of_the_run() -> None:
    console = _Console("single-thread", speed=20.0)
    console.until(RobotMoved, 10)
    console.session.send(CallService("/motor_power", data=False))
    reply = console.until(ServiceReplied)
    assert isinstance(reply, ServiceReplied)
    assert "motors off" in reply.response
    given = console.until(CommandGiven)
    assert given.t == reply.t
    before = sum(isinstance(event, RobotMoved) for event in console.events)
    moved = console.until(RobotMoved, before + 1)
    assert isinstance(moved, RobotMoved)
    assert not moved.motors
    console.session.stop()


def test_a_call_of_a_service_that_nobody_offers_is_said_to_be_lost() -> None:
    console = _Console("single-thread", speed=20.0)
    console.session.send(CallService("/nobody", data=True))
    notice = console.until(Notice)
    assert isinstance(notice, Notice)
    assert notice.text == "nobody offers /nobody yet, so the call is lost"
    console.session.stop()


def test_a_paused_run_stands_still_until_it_is_resumed() -> None:
    console = _Console("split-groups", speed=20.0)
    console.until(RobotMoved, 5)
    console.session.send(Pause())
    console.session.send(CallService("/motor_power", data=True))
    console.session.send(ResetWorld())
    asked = console.until(CommandGiven, 3)
    paused = console.until(CommandGiven, 1)
    assert asked.t == paused.t
    console.session.send(Resume())
    resumed = console.until(CommandGiven, 4)
    assert resumed.t == paused.t
    console.session.send(SetSpeed(None))
    console.until(RobotMoved, 1000)
    times = [event.t for event in console.events]
    assert times == sorted(times)
    console.session.stop()


def test_real_time_runs_the_same_program(tmp_path: Path) -> None:
    body = "node.create_timer(0.1, lambda: node.get_logger().info('tick'))"
    run = run_program(tmp_path, SPIN.format(body=body), seconds=2.05, clock="real")
    assert run.ending.reason == "its time was up"
    times = [at for at, text in run.logs() if text == "tick"]
    assert 5 <= len(times) <= 20
    assert all(at >= 0.1 * (index + 1) for index, at in enumerate(times))
    assert times == sorted(times)
