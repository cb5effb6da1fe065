"""The rule on waits without a timeout, for notices with and without the fields that older recordings lack."""

from pathlib import Path
from typing import Any

import msgspec
import pytest

from sim.diagnosis import CodeLocation, Explanation, Weight
from sim.diagnosis.diagnoses import diagnose
from sim.diagnosis.edits.flags import event_setters
from sim.engine.watchdogs import hung_callbacks, outside_time
from sim.trace.events import (
    AnyEvent,
    CallbackAt,
    CallbackEnded,
    CallbackStarted,
    Doing,
    Logged,
    Notice,
    NoticeKind,
    Reason,
    RunStarted,
    Severity,
    ThreadAppeared,
    TimePassed,
    WaitStarted,
    decode,
)
from sim.trace.timeline import Timeline
from tests.support.builder import ns
from tests.support.engine_runs import program_setup, run_program, run_to_end
from tests.trace.samples import CAST

PROGRAMS = Path(__file__).parent / "beginners"


def explained(*events: AnyEvent, rule: str = "endless-wait") -> list[tuple[str, str]]:
    timeline = Timeline()
    timeline.extend([*CAST, *events])
    told = [(found, found.explained(timeline)) for found in diagnose(timeline)]
    return [(each.what, each.cure) for found, each in told if found.rule.id == rule]


def test_what_is_wrong_and_what_to_do_are_fields_of_the_notice() -> None:
    fields = ("it waits; its own lock", "let; go")
    notice = Notice(1, Severity.WARN, "words", 1, False, NoticeKind.DEADLOCK, *fields)
    assert explained(notice) == [("odom_callback is in a deadlock: it waits; its own lock", "let; go")]


def test_the_line_of_a_wait_is_the_one_that_its_notice_names() -> None:
    notice = Notice(2, Severity.WARN, "words", 1, kind=NoticeKind.ENDLESS_WAIT, place=("node.py", 63))
    timeline = Timeline()
    timeline.extend([*CAST, CallbackStarted(1, 1, 1, 0, 0, 0), notice])
    [found] = [each for each in diagnose(timeline) if each.rule.id == "endless-wait"]
    assert found.explained(timeline).place == CodeLocation("node.py", 63, 63)


def test_a_recording_without_these_fields_is_told_in_the_words_of_its_notice() -> None:
    old = [["notice", 1, "ERROR", "deadlock: it waits; let go", 1]]
    events = decode(msgspec.msgpack.encode(old))
    assert explained(*events) == [
        (
            "odom_callback: deadlock: it waits; let go",
            "wait with a timeout, and make sure that something ends the wait",
        )
    ]


def test_what_a_recording_from_before_keepers_tells_of_a_lock_is_where_it_was() -> None:
    frames = [["node.py", "callback", 60]]
    old = [["callback_at", 9, 1, 2, Doing.WAITS.value, "Lock.acquire", frames, ["", 0], 3, 40]]
    (event,) = decode(msgspec.msgpack.encode(old))
    assert isinstance(event, CallbackAt)
    assert (event.holder, event.until, event.keeper) == (3, 40, 0)


def _at_a_lock(t: int, entity: int, thread: int, line: int, holder: int = 0) -> CallbackAt:
    frames = (("node.py", "callback", line),)
    return CallbackAt(t, entity, thread, Doing.WAITS, "Lock.acquire", frames, holder=holder)


@pytest.mark.parametrize(
    ("seconds", "clock", "holder"), [(1.9, "real", 0), (3, "virtual", 0), (3, "real", 1)]
)
def test_a_short_wait_for_a_lock_and_one_that_others_know_more_of_is_not_told(
    seconds: float, clock: str, holder: int
) -> None:
    start, at, over = RunStarted(0, "t", clock, 0), _at_a_lock(9, 1, 1, 60, holder), TimePassed(ns(seconds))
    assert explained(start, CallbackStarted(5, 1, 1, 0, 0, 0), at, over, rule="waits-for-lock") == []


def test_who_waits_for_locks_is_told_with_the_lines_and_nothing_else_is_their_fault() -> None:
    timeline = Timeline()
    waits = WaitStarted(ns(0.5), 2, ns(0.5), Reason.NO_FREE_WORKER, 1, True)
    timeline.extend([*CAST, RunStarted(0, "t", "real", 0), CallbackStarted(5, 1, 1, 0, 0, 0)])
    timeline.extend([_at_a_lock(9, 1, 1, 60), waits, TimePassed(ns(3))])
    [found] = [each for each in diagnose(timeline) if each.weight_in(timeline) is Weight.PROBLEM]
    told = found.explained(timeline)
    assert told.what == "odom_callback (node.py:60) has waited for a lock for 3.0 s"
    assert told.cure.startswith("take locks in the same order everywhere")


def test_one_lock_that_is_waited_for_is_to_be_released_and_several_to_be_taken_in_one_order() -> None:
    def told(*locks: str, lines: int = 1) -> Explanation:
        timeline = Timeline()
        timeline.extend([*CAST, RunStarted(0, "t", "real", 0)])
        for thread, lock in enumerate(locks, 1):
            timeline.extend([ThreadAppeared(0, thread, f"T{thread}"), CallbackStarted(5, 1, thread, 0, 0, 0)])
            timeline.extend(
                [msgspec.structs.replace(_at_a_lock(8 + thread, 1, thread, 59 + thread * lines), lock=lock)]
            )
        timeline.extend([TimePassed(ns(3))])
        [found] = [each for each in diagnose(timeline) if each.rule.id == "waits-for-lock"]
        return found.explained(timeline)

    one, two, local = told("self.a", "self.a"), told("self.a", "self.b"), told("lock", "lock")
    assert local.cure == two.cure, "one name of a variable may stand for several locks"
    assert one.what.startswith("odom_callback (node.py:60) has waited for self.a for 3.0 s, and so does ")
    assert one.cure.startswith("take self.a by with everywhere, which releases it")
    assert two.what.endswith("and so does odom_callback (node.py:61) for self.b")
    assert two.cure.startswith("take locks in the same order everywhere")
    alike = told("self.a", "self.a", "self.a", lines=0)
    assert alike.what == "odom_callback (node.py:59) has waited for self.a for 3.0 s"


def _in_a_loop(t: float, file: str = "node.py", line: int = 62) -> CallbackAt:
    frames = ((file, "callback", line + 1),)
    return CallbackAt(ns(t), 1, 1, Doing.COMPUTES, "", frames, loop=(file, line))


def test_a_callback_that_has_been_in_a_loop_is_told_with_what_it_keeps_waiting() -> None:
    begun, waits = (
        CallbackStarted(5, 1, 1, 0, 0, 0),
        WaitStarted(ns(0.5), 2, ns(0.5), Reason.GROUP_HELD, 1, True),
    )
    ((what, cure),) = explained(begun, _in_a_loop(0.2), waits, TimePassed(ns(2.2)), rule="stays-in-loop")
    assert what.startswith("odom_callback has been in the loop of line 62 for 2.0 s; ")
    assert what.endswith(" can run only when it is over")
    assert cure == (
        "keep the state in self and return: odom_callback begins a timer that does one step of the loop at "
        "each call"
    )


@pytest.mark.parametrize(
    "later",
    [
        [TimePassed(ns(1.6))],
        [_in_a_loop(1.0, line=70), TimePassed(ns(2.2))],
        [CallbackEnded(ns(2.0), 1, 1), TimePassed(ns(2.2))],
    ],
    ids=["for less than 1.5 s", "now in another", "left"],
)
def test_a_loop_that_may_be_a_short_one_is_not_told(later: list[AnyEvent]) -> None:
    begun = CallbackStarted(5, 1, 1, 0, 0, 0)
    assert explained(begun, _in_a_loop(0.2), *later, rule="stays-in-loop") == []


def test_a_notice_on_something_else_hides_no_loop() -> None:
    begun = CallbackStarted(5, 1, 1, 0, 0, 0)
    notice = Notice(6, Severity.WARN, "words", 1, kind=NoticeKind.REFUSAL_OVERLOOKED)
    assert len(explained(begun, notice, _in_a_loop(0.2), TimePassed(ns(2.2)), rule="stays-in-loop")) == 1


@pytest.mark.parametrize(("condition", "told"), [("time.monotonic() < end", 0), ("not self.done", 1)])
def test_a_loop_that_a_clock_ends_is_not_told(condition: str, told: int, tmp_path: Path) -> None:
    path = tmp_path / "node.py"
    path.write_text(f"while {condition}:\n    pass\n")
    begun, at = CallbackStarted(5, 1, 1, 0, 0, 0), _in_a_loop(0.2, str(path), 1)
    assert len(explained(begun, at, TimePassed(ns(2.2)), rule="stays-in-loop")) == told


def test_of_a_callback_that_computes_it_is_said_how_long_and_not_that_it_never_ends() -> None:
    notice = Notice(
        1, Severity.WARN, "words", 1, kind=NoticeKind.NO_PROGRESS, problem="has not come back for 1.5 s"
    )
    ((what, _),) = explained(notice, rule="still-computing")
    assert what == "odom_callback computes and has not come back for 1.5 s"


def test_on_the_real_clock_a_callback_that_computes_has_not_come_back_for_longer_and_longer() -> None:
    start, begun = RunStarted(0, "t", "real", 0), CallbackStarted(5, 1, 1, 0, 0, 0)
    problem = "has not come back for 1.5 s"
    notice = Notice(ns(1.5), Severity.WARN, "words", 1, kind=NoticeKind.NO_PROGRESS, problem=problem)
    ((what, _),) = explained(start, begun, notice, TimePassed(ns(4.0)), rule="still-computing")
    assert what == "odom_callback computes and has not come back for 4.0 s"


def test_of_calls_at_once_the_one_that_is_told_of_is_the_one_that_the_engine_saw() -> None:
    older = CallbackAt(
        ns(1.0), 1, 1, Doing.WAITS, "Lock.acquire", (("node.py", "callback", 37),), lock="lock"
    )
    newer = CallbackAt(ns(2.9), 1, 2, Doing.SLEEPS, "time.sleep", (("node.py", "callback", 39),))
    problem = "has not come back since 1.0 s"
    notice = Notice(ns(3.0), Severity.WARN, "", 1, kind=NoticeKind.NO_PROGRESS, problem=problem, thread=1)
    run = [
        RunStarted(0, "t", "real", 0),
        CallbackStarted(ns(0.9), 1, 1, 0, 0, 0),
        older,
        CallbackStarted(ns(2.8), 1, 2, 0, 0, 0),
        newer,
        notice,
        TimePassed(ns(4.9)),
    ]
    [(what, _)] = explained(*run)
    assert what.startswith("odom_callback waits for lock, and has not come back for 4.0 s")
    sleeps = CallbackAt(ns(4.8), 1, 1, Doing.SLEEPS, "time.sleep", newer.frames)
    assert explained(*run[:-1], sleeps, run[-1]) == []
    assert explained(*run[:-1], CallbackEnded(ns(4.8), 1, 1), run[-1]) == []


@pytest.mark.parametrize("watch", [hung_callbacks, outside_time])
def test_a_callback_that_computes_is_reported_after_one_and_a_half_seconds(watch: Any) -> None:
    assert pytest.approx(1.5) == watch._LOOK * watch._PATIENCE
    assert "has not come back for 1.5 " in outside_time._PROBLEM


@pytest.mark.parametrize(
    ("waits", "ends"),
    [
        ("self.gate.wait()", "self.gate.set()"),
        ("item = self.items.get()", "self.items.put(1)"),
        ("self.places.acquire()", "self.places.release()"),
        ("await self.ready", "self.ready.set_result(True)"),
    ],
)
def test_the_functions_that_end_a_wait_are_found(waits: str, ends: str, tmp_path: Path) -> None:
    path = tmp_path / "node.py"
    both = f"        {waits}\n        {ends}\n"
    path.write_text(f"class N:\n    async def a(self):\n{both}    def b(self):\n        {ends}\n")
    assert event_setters(str(path), 3) == ("b",)


def test_a_semaphore_is_no_lock(tmp_path: Path) -> None:
    run = run_to_end(program_setup(PROGRAMS / "semaphore_in_reentrant_group.py", 2.0))
    assert {
        each.call for each in run.events if isinstance(each, CallbackAt) and each.doing is Doing.WAITS
    } == {"Semaphore.acquire"}


WAITS_IN_A_REENTRANT_GROUP = """\
import threading
import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node

rclpy.init()
node, ready = Node("n"), threading.Event()

def work():
    ready.wait()

def release():
    ready.set()

node.create_timer(1.0, work, callback_group=ReentrantCallbackGroup())
node.create_timer(20.0, release, callback_group=ReentrantCallbackGroup())
executor = MultiThreadedExecutor(3)
executor.add_node(node)
executor.spin()
"""


def test_calls_that_wait_beside_each_other_and_keep_nobody_from_running_are_told(tmp_path: Path) -> None:
    run = run_program(tmp_path, WAITS_IN_A_REENTRANT_GROUP, 6.0)
    (found,) = (each for each in diagnose(run.timeline) if each.rule.id == "endless-wait")
    told = found.explained(run.timeline)
    assert "ready.set() in release (node.py:14) would end it" in told.what
    assert "can run only" not in told.what
    assert "give work a MutuallyExclusiveCallbackGroup" in told.cure


TAKES_JOBS = """\
import queue
import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node

rclpy.init()
node, jobs = Node("n"), queue.Queue()

def work():
    while True:
        jobs.get()

def feed():
    jobs.put(1)

node.create_timer(1.0, work, callback_group=MutuallyExclusiveCallbackGroup())
node.create_timer({period}, feed)
executor = MultiThreadedExecutor(2)
executor.add_node(node)
executor.spin()
"""


@pytest.mark.parametrize(("period", "told"), [(0.5, 0), (4.5, 0), (60.0, 1)])
def test_a_worker_that_gets_its_next_job_now_and_then_does_not_stand_still(
    period: float, told: int, tmp_path: Path
) -> None:
    timeline = run_program(tmp_path, TAKES_JOBS.format(period=period), 12.0).timeline
    problems = [each.rule.id for each in diagnose(timeline) if each.weight_in(timeline) is Weight.PROBLEM]
    assert problems.count("endless-wait") == told
    assert "stays-in-loop" not in problems


@pytest.mark.parametrize("sign", ["a log line", "another line", "none", "a log line of another"])
def test_a_wait_in_a_loop_is_over_when_its_call_is_seen_to_go_on(sign: str) -> None:
    frames = (("node.py", "callback", 63),)
    at = CallbackAt(ns(0.2), 1, 1, Doing.WAITS, "Queue.get", frames, loop=("node.py", 62))
    problem = "has not come back for 1.5 s"
    notice = Notice(ns(1.5), Severity.WARN, "words", 1, kind=NoticeKind.NO_PROGRESS, problem=problem)
    later: dict[str, AnyEvent] = {
        "a log line": Logged(ns(2.0), Severity.INFO, "n", "job 1", 1, 1),
        "another line": _in_a_loop(2.0, line=64),
        "a log line of another": Logged(ns(2.0), Severity.INFO, "n", "job 1", 2, 2),
    }
    signs = [later[sign]] if sign in later else []
    begun = CallbackStarted(5, 1, 1, 0, 0, 0)
    found = explained(begun, at, notice, *signs, TimePassed(ns(9.0)))
    assert bool(found) is (sign not in ("a log line", "another line"))
