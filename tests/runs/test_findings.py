"""Looking for what the rules find while a run goes on: how often, and what is kept of it."""

from collections.abc import Iterator, Sequence
from pathlib import Path

import pytest

from cbtui.runs.live.findings import FindingsMonitor, Standstill, problem_count_text
from cbtui.widgets.diagnosis import Diagnosis, DiagnosisLevel, with_worst_problem
from sim.diagnosis import Diagnoses, Explanation, Finding, Weight
from sim.diagnosis.rule import Rule
from sim.diagnosis.timeline_view import TimelineView
from sim.ros.node.node import Node
from sim.ros.scheduling.callback_groups import MutuallyExclusiveCallbackGroup
from sim.trace.timeline import Timeline
from tests.diagnosis.findings import SetBool, diagnosed, once, serve_outside, spin
from tests.support.builder import Run, ns
from tests.support.engine_runs import run_program
from tests.support.runs import shared_group_run, split_groups_run
from tests.support.simulation import Simulation


def calling(*, beats: bool, logs: bool = False, answers_in: float = 0.0) -> FindingsMonitor:
    """Two threads, and a callback that at 1 s calls a service whose reply its own group keeps out."""

    def program(simulation: Simulation) -> None:
        serve_outside(simulation, seconds=answers_in)
        node = Node("n")
        group = MutuallyExclusiveCallbackGroup()
        client = node.create_client(SetBool, "/outside", callback_group=group)
        once(node, 1.0, lambda: client.call(SetBool.Request()), group)
        if logs:
            simulation.at(9.5, lambda: node.get_logger().info("round"))
        if beats:
            node.create_timer(0.5, lambda: None, callback_group=MutuallyExclusiveCallbackGroup())
        spin(node, 2)

    watch = FindingsMonitor(diagnosed(program).timeline)
    watch.update()
    return watch


def test_nothing_moves_once_all_that_runs_is_stuck() -> None:
    watch = calling(beats=False)
    assert watch.standstill() == Standstill(ns(1.0))
    stuck = watch.stuck_at(ns(1.5))
    assert stuck is not None
    assert len(stuck.ring) == 4
    assert watch.stuck_at(ns(0.5)) is None


def test_a_deadlock_is_none_before_the_last_of_its_waits_begins() -> None:
    watch = calling(beats=False, answers_in=0.3)
    [found] = watch.findings
    assert (found.finding.at, found.finding.known_at) == (ns(1.0), ns(1.3))
    assert watch.stuck_at(ns(1.2)) is None
    assert watch.stuck_at(ns(1.3)) is found.finding
    moment = Diagnosis("tick waits", DiagnosisLevel.PENDING)
    assert with_worst_problem(moment, watch.findings, at=ns(1.2)) is moment
    assert "for ever" in with_worst_problem(moment, watch.findings, at=ns(1.3)).text


def test_a_program_of_which_a_part_goes_on_still_moves() -> None:
    watch = calling(beats=True)
    assert watch.stuck_at(ns(1.5)) is not None
    assert watch.standstill() is None


def test_of_a_program_that_logs_the_thread_that_does_is_said_to_move() -> None:
    watch = calling(beats=False, logs=True)
    assert watch.standstill() == Standstill(ns(1.0), "server")


_POLLS = """
import time
import rclpy

ready = []


def work():
    WAIT


rclpy.init()
node = rclpy.create_node("poller")
node.create_timer(1.0, work)
node.create_timer(0.2, lambda: ready.append(1) if node.get_clock().now().nanoseconds < 0 else None)
rclpy.spin(node)
"""


@pytest.mark.parametrize(
    ("wait", "until", "only"),
    [
        ("while not ready: time.sleep(0.01)", 1.9, ""),
        ("while not ready: time.sleep(0.01)", 2.1, "work"),
        ("time.sleep(5.0)", 2.1, ""),
    ],
    ids=["not yet", "polls", "sleeps"],
)
def test_a_callback_that_polls_while_all_others_wait_for_it_starves_them(
    wait: str, until: float, only: str, tmp_path: Path
) -> None:
    watch = FindingsMonitor(run_program(tmp_path, _POLLS.replace("WAIT", wait), until).timeline)
    watch.update()
    still = watch.standstill()
    assert (still.only if still else "") == only


_KEEPS = """
import threading, time
import rclpy
from rclpy.node import Node

def compute():
    end = time.monotonic() + 9
    while time.monotonic() < end:
        pass

def keep():
    with lock:
        KEEP

def tick():
    with lock:
        pass

def look():
    pass

def beside():
    BESIDE

rclpy.init()
node = Node("n")
lock = threading.Lock()
threading.Thread(target=keep, daemon=True, name="keeper").start()
threading.Thread(target=beside, daemon=True, name="beside").start()
node.create_timer(0.2, tick)
rclpy.spin(node)
"""


_WAITS = "threading.Event().wait()"


@pytest.mark.parametrize(
    ("keep", "beside", "moves"),
    [
        ("time.sleep(9)", "pass", None),
        ("compute()", "pass", "keeper"),
        ("compute()", "compute()", None),
        (_WAITS, "pass", ""),
        (_WAITS, "compute()", "beside"),
        (_WAITS, "while True:\n        time.sleep(0.4)", ""),
        (_WAITS, "while rclpy.ok():\n        time.sleep(0.4)\n        look()", "beside"),
        (
            _WAITS,
            "while rclpy.ok():\n        time.sleep(0.4)\n        node.get_logger().info('on')",
            "beside",
        ),
    ],
)
def test_of_a_stuck_program_the_one_thread_of_its_own_that_goes_on_is_told(
    tmp_path: Path, keep: str, beside: str, moves: str | None
) -> None:
    program = _KEEPS.replace("KEEP", keep).replace("BESIDE", beside)
    watch = FindingsMonitor(run_program(tmp_path, program, 4.0, "real").timeline)
    watch.update()
    comes_back = keep == "time.sleep(9)"
    assert (watch.stuck_at(ns(3.0)) is None) == comes_back
    still = watch.standstill()
    assert (None if still is None else still.moves) == moves


class Counting(Rule):
    """Finds how often it was asked, and takes as much time as it is told to."""

    id = "how-often"
    summary = "counts"

    def __init__(self, clock: "Clock", takes: float = 0.0) -> None:
        self.asked = 0
        self._clock = clock
        self.takes = takes

    def check(self, look: TimelineView) -> Iterator[Finding]:
        self.asked += 1
        self._clock.now += self.takes
        yield Finding(self, 1, look.end + 2, size=self.asked)

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        return Explanation("it was asked", "it counts", "do not ask", None)


class Clock:
    now = 100.0

    def __call__(self) -> float:
        return self.now


def watched(clock: Clock, takes: float = 0.0, *, computes: bool = True) -> tuple[FindingsMonitor, Counting]:
    rule = Counting(clock, takes)
    return FindingsMonitor(Timeline(), Diagnoses([rule]), clock, clock if computes else float), rule


def watch_of(run: Run, until: float) -> FindingsMonitor:
    timeline = Timeline()
    timeline.extend(run.until(until))
    watch = FindingsMonitor(timeline)
    watch.update()
    return watch


def at_frames(watch: FindingsMonitor, clock: Clock, seconds: Sequence[float]) -> list[bool]:
    looked = []
    for second in seconds:
        clock.now = second
        looked.append(watch.update_when_due())
    return looked


def test_the_rules_look_twice_a_second_however_often_they_could() -> None:
    clock = Clock()
    watch, rule = watched(clock)
    at_frames(watch, clock, [100 + frame / 30 for frame in range(300)])
    assert rule.asked == 20


def test_what_the_engine_reports_is_looked_at_at_once() -> None:
    clock = Clock()
    watch, _ = watched(clock)
    at_frames(watch, clock, [100.0])
    run = Run("hung")
    run.notice("tick has not come back for 1.5 s", 1.0)
    watch._timeline.extend(run.events)
    assert at_frames(watch, clock, [100.1, 100.2]) == [True, False]


def test_after_dear_looks_the_rules_rest_a_hundred_times_as_long() -> None:
    clock = Clock()
    watch, rule = watched(clock, takes=0.05)
    assert at_frames(watch, clock, [99.0, 100.0, 101.5, 104.9]) == [True, True, False, False]
    assert at_frames(watch, clock, [105.06]) == [True]
    assert rule.asked == 3


def test_what_is_dear_once_does_not_put_off_the_next_look() -> None:
    clock = Clock()
    watch, rule = watched(clock, takes=0.2)
    at_frames(watch, clock, [100.0])
    rule.takes = 0.0
    at_frames(watch, clock, [100.6, 101.2])
    assert rule.asked == 3


def test_a_look_that_waits_for_a_processor_does_not_put_off_the_next() -> None:
    clock = Clock()
    watch, rule = watched(clock, takes=0.2, computes=False)
    at_frames(watch, clock, [100.0, 100.4, 100.6])
    assert rule.asked == 2


def test_what_is_read_of_a_recording_between_two_frames_is_looked_at_before_it_is_minutes() -> None:
    clock, starts = Clock(), []

    class Noting(Counting):
        def check(self, look: TimelineView) -> Iterator[Finding]:
            starts.append(look.window.length)
            return iter(())

    timeline = Timeline()
    watch = FindingsMonitor(timeline, Diagnoses([Noting(clock)]), clock)
    run = Run("long")
    for second in range(0, 600, 8):
        run.log("here", float(second))
        timeline.extend(run.events[-1:])
        watch.update_when_due()
    watch.update()
    assert max(starts) < ns(30)
    assert len(starts) < 40


def test_looking_now_waits_for_nothing_and_puts_off_the_next_look() -> None:
    clock = Clock()
    watch, rule = watched(clock)
    watch.update()
    watch.update()
    assert at_frames(watch, clock, [100.4, 100.6]) == [False, True]
    assert rule.asked == 3


def test_a_look_that_finds_the_same_has_nothing_new_to_tell() -> None:
    clock = Clock()
    watch = FindingsMonitor(Timeline(), clock=clock)
    assert at_frames(watch, clock, [100.0, 102.0, 104.0]) == [False, False, False]


def test_what_was_found_comes_with_weight_and_words_problems_first() -> None:
    told = watch_of(shared_group_run(), 20.0).findings
    assert [each.weight for each in told] == sorted((each.weight for each in told), key=str)
    starved = next(each for each in told if each.name == "group starvation")
    assert starved.is_problem
    assert starved.leads_somewhere
    assert starved.explanation.what.startswith("odom_callback and scan_callback waited up to 16.0 s: ")


def test_problems_are_counted_and_remarks_are_not() -> None:
    told = watch_of(shared_group_run(), 20.0).findings
    problems = [each for each in told if each.weight is Weight.PROBLEM]
    assert len(told) > len(problems)
    assert problem_count_text(told) == "1 problem"
    assert problem_count_text(problems * 2) == "2 problems"
    assert problem_count_text(watch_of(split_groups_run(), 20.0).findings) == ""


def test_what_is_true_of_a_whole_run_leads_nowhere() -> None:
    told = watch_of(split_groups_run(), 6.9).findings  # before the service is called
    unused = next(each for each in told if each.name == "threads never used")
    assert unused.at is None
    assert not unused.leads_somewhere
