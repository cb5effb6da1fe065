"""A program that lets no time pass: it is told, takes inputs, and is repeated from them."""

import time
from pathlib import Path
from queue import Queue

import msgspec
import pytest

from cbtui.engines.session import ProcessSession
from sim.clock.recesses import RECESS
from sim.engine.commands import CallService, InputCommand, Stop
from sim.engine.inputs import inputs_of
from sim.trace.events import (
    AnyEvent,
    CommandGiven,
    InputGiven,
    Logged,
    Notice,
    RunEnded,
    TimeHalted,
    TimePassed,
)
from tests.support.engine_runs import SECOND, program_setup, run_to_end

PATIENCE = 60.0
"""Real seconds: ten times what it takes on a quiet machine."""

DAWDLES = """
import time
import rclpy
from rclpy.node import Node
from std_srvs.srv import SetBool

class Dawdler(Node):
    def __init__(self):
        super().__init__("dawdler")
        self.heard = 0
        self.create_service(SetBool, "go", self.hear)

    def hear(self, request, response):
        self.heard += 1
        self.get_logger().info(f"heard {self.heard}")
        return response

rclpy.init()
node = Dawdler()
while node.heard < 2:
    rclpy.spin_once(node, timeout_sec=0.0)
    time.sleep(0)
node.get_logger().info("on it goes")
time.sleep(1.0)
"""


def live(folder: Path, *given: InputCommand) -> list[AnyEvent]:
    """Run the dawdler as fast as it can, with inputs, each when the one before was heard; all events."""
    path = folder / "node.py"
    path.write_text(DAWDLES)
    news: Queue[list[AnyEvent] | str | None] = Queue()
    session = ProcessSession(
        msgspec.structs.replace(program_setup(path, 60.0), speed=1.0), news.put, news.put
    )
    events: list[AnyEvent] = []
    waiting = list(given)
    session.start()
    try:
        session.send(waiting.pop(0))
        while isinstance(batch := news.get(timeout=60), list):
            events += batch
            if any(isinstance(event, Logged) for event in batch) and waiting:
                session.send(waiting.pop(0))
    finally:
        session.stop()
    return events


def without_notices(events: list[AnyEvent]) -> list[AnyEvent]:
    return [
        event for event in events if not isinstance(event, (Notice, CommandGiven, TimeHalted, TimePassed))
    ]


def test_a_program_that_waits_without_time_takes_its_inputs_and_is_repeated_from_them(tmp_path: Path) -> None:
    events = live(tmp_path, CallService("/go", True), CallService("/go", False))
    given = [event for event in events if isinstance(event, InputGiven)]
    assert 0 < given[0].recess < given[1].recess
    assert [event.t for event in given] == [(event.recess - 1) * RECESS for event in given]
    assert isinstance(events[-1], RunEnded)
    assert not events[-1].failed
    setup = msgspec.structs.replace(program_setup(tmp_path / "node.py", 60.0), inputs=inputs_of(events))
    assert without_notices(run_to_end(setup).events)[1:] == without_notices(events)[1:]


def test_that_time_stands_is_told_once_with_the_place(tmp_path: Path) -> None:
    path = tmp_path / "node.py"
    path.write_text("import time\n\ndef dawdle():\n    while True:\n        time.sleep(0)\n\ndawdle()\n")
    run = run_to_end(program_setup(path, 60.0))
    told = [event for event in run.events if isinstance(event, Notice)]
    assert [notice.text.partition(";")[0] for notice in told] == [
        "time stands still: MainThread (node.py:5, in dawdle) and whatever else runs came to more than "
        "10,000 waits in one moment"
    ]
    assert told[0].text.endswith("let it sleep a little, or run the file by itself with --clock real")
    ended = run.events[-1]
    assert isinstance(ended, RunEnded)
    assert ended.failed
    assert ended.reason == told[0].text


@pytest.mark.slow
@pytest.mark.parametrize(
    ("body", "why"), [("time.sleep(0)", "time stands still"), ("pass", "MainThread does not come to a wait")]
)
def test_a_run_that_is_stuck_is_ended(tmp_path: Path, body: str, why: str) -> None:
    path = tmp_path / "node.py"
    path.write_text(f"import time\nwhile True: {body}\n")
    news: Queue[list[AnyEvent] | str | None] = Queue()
    session = ProcessSession(program_setup(path, 60.0), news.put, news.put)
    session.start()
    try:
        news.get(timeout=60)
        began = time.monotonic()
        while isinstance(batch := news.get(timeout=60), list):
            ended = batch[-1]
    finally:
        session.stop()
    assert time.monotonic() - began < PATIENCE
    assert isinstance(ended, RunEnded)
    assert ended.reason.startswith(why)


@pytest.mark.slow
def test_code_in_c_that_comes_to_no_end_is_ended_and_named(tmp_path: Path) -> None:
    path = tmp_path / "node.py"
    path.write_text("def count():\n    return sum(range(10**12))\ncount()\n")
    began = time.monotonic()
    run = run_to_end(program_setup(path, 60.0))
    assert time.monotonic() - began < PATIENCE
    assert run.loss is not None
    assert run.loss.startswith("code in C held up virtual time")
    assert run.loss.endswith("(node.py:2, in count)")


def test_a_loop_that_waits_until_its_deadline_is_behind_it_is_not_blamed(tmp_path: Path) -> None:
    path = tmp_path / "node.py"
    path.write_text(
        "import concurrent.futures, time\n"
        "def loop(end):\n"
        "    while time.time() <= end: time.sleep(max(0, end - time.time()))\n"
        "with concurrent.futures.ThreadPoolExecutor(12) as pool:\n"
        "    jobs = [pool.submit(loop, time.time() + 1) for _ in range(12)]\n"
        "    try:\n"
        "        list(concurrent.futures.as_completed(jobs, timeout=0.1))\n"
        "    except TimeoutError:\n"
        "        pass\n"
    )
    run = run_to_end(program_setup(path, 60.0))
    assert not any(isinstance(event, Notice) for event in run.events)
    assert not run.ending.failed
    assert 1.0 <= run.ending.t / SECOND < 1.00001


def test_a_program_that_lets_no_time_pass_can_be_stopped(tmp_path: Path) -> None:
    events = live(tmp_path, Stop())
    assert isinstance(events[-1], RunEnded)
    assert events[-1].reason == "it was stopped"
