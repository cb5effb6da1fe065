"""A comparison says which problems of one run the other has not; on runs of beginners' programs."""

from functools import cache
from pathlib import Path

from msgspec.structs import replace

from cbtui.runs.judged.compared_problems import ComparedProblems
from sim.engine.setup import GroupChange
from sim.trace.figures.comparison import compare
from sim.trace.figures.comparison_sentences import headline, is_tie
from sim.trace.model import Window
from sim.trace.timeline import Timeline
from tests.support.engine_runs import program_setup, run_lesson, run_to_end

PROGRAMS = Path(__file__).parents[1] / "diagnosis" / "beginners"


@cache
def run_of(program: str, seconds: float = 6.0) -> Timeline:
    return run_to_end(program_setup(PROGRAMS / f"{program}.py", seconds)).timeline


@cache
def well_run() -> Timeline:
    return run_lesson("split-groups", 6.0).timeline


def told(first: Timeline, second: Timeline) -> str:
    return ComparedProblems(first, second).compared().told


def speaks(first: Timeline, second: Timeline) -> int | None:
    return ComparedProblems(first, second).compared().speaks


def test_a_deadlock_is_gone_or_still_there_or_new() -> None:
    stuck, well = run_of("call_in_timer"), well_run()
    assert told(stuck, well) == "The deadlock is gone."
    assert told(stuck, stuck) == "The deadlock is still there."
    assert told(well, stuck) == "Run B has a deadlock that run A has not."
    assert told(well, well) == ""
    assert told(stuck, run_of("lock_across_callbacks")) == "The deadlock is gone, but run B has another one."


TWO_CALLS = """
import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_srvs.srv import Trigger


class Asker(Node):
    def __init__(self):
        super().__init__("asker")
        self.create_service(Trigger, "answer", self.answer, callback_group=MutuallyExclusiveCallbackGroup())
        for name in ("low", "high"):
            group = MutuallyExclusiveCallbackGroup()
            client = self.create_client(Trigger, "answer", callback_group=group)
            setattr(self, f"client_{name}", client)
            self.create_timer(1.0, getattr(self, name), callback_group=group)

    def answer(self, request, response):
        return response

    def low(self):
        self.client_low.call(Trigger.Request())

    def high(self):
        self.client_high.call(Trigger.Request())


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=4)
    executor.add_node(Asker())
    executor.spin()


main()
"""


def test_of_several_deadlocks_some_may_be_gone(tmp_path: Path) -> None:
    path = tmp_path / "two_calls.py"
    path.write_text(TWO_CALLS)
    setup = program_setup(path, 6.0)
    both = run_to_end(setup).timeline
    one = run_to_end(replace(setup, groups=(GroupChange("", "low", "own"),))).timeline
    assert told(both, one) == "Of 2 deadlocks one is gone in run B."
    assert told(both, both) == "The deadlock is still there."
    assert told(one, both) == "The deadlock is still there."


def test_a_wait_without_end_that_is_no_deadlock_is_a_hang() -> None:
    well = well_run()
    assert told(run_of("wait_for_service"), well) == "The hang is gone."


def test_other_problems_are_gone_or_new_too() -> None:
    starved, deaf = run_of("held_group"), run_of("qos_mismatch")
    assert told(starved, starved) == "Still in run B: wait for a group."
    assert told(starved, deaf) == "Gone in run B: wait for a group. New in run B: QoS mismatch."
    assert told(run_of("call_in_timer"), deaf) == "The deadlock is gone. New in run B: QoS mismatch."


def test_a_problem_is_called_by_what_a_learner_sees() -> None:
    slow = run_of("call_longer_than_period")
    assert told(well_run(), slow) == "New in run B: callback longer than its timer's period."


def test_what_is_gone_speaks_for_a_run_and_what_is_new_against_it_and_a_hang_most() -> None:
    stuck, starved, well, deaf = (
        run_of("call_in_timer"),
        run_of("held_group"),
        well_run(),
        run_of("qos_mismatch"),
    )
    assert speaks(stuck, well) == 1
    assert speaks(well, stuck) == -1
    assert speaks(stuck, stuck) is speaks(well, well) is speaks(starved, starved) is None
    assert speaks(starved, deaf) == speaks(stuck, run_of("lock_across_callbacks")) == 0
    assert speaks(stuck, deaf) == 1
    assert speaks(stuck, run_of("sleep_in_service", seconds=0.2)) is None
    assert [ComparedProblems(stuck, each).compared().stuck for each in (stuck, well)] == [True, False]


def test_of_a_hang_shortly_before_the_end_of_the_runs_is_said_what_each_shows() -> None:
    stuck, well = run_of("call_in_timer", 2.0), run_lesson("split-groups", 2.0).timeline
    assert told(stuck, well) == "Run A has a deadlock, run B shows none up to 2.000 s."
    assert told(well, stuck) == "Run B has a deadlock, run A shows none up to 2.000 s."
    assert speaks(stuck, well) is None
    well = run_lesson("split-groups", 1.95).timeline  # as on the real clock, on which no two ends are one
    assert told(stuck, well) == "Run A has a deadlock, run B shows none up to 1.950 s."


CAMERA = """
import time
import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Int32

class Detector(Node):
    def __init__(self):
        super().__init__("detector")
        self.create_subscription(Int32, "frames", self.on_frame, 10)
        self.frames = self.create_publisher(Int32, "frames", 10)
        self.create_timer(0.2, self.grab, MutuallyExclusiveCallbackGroup())
        self.create_timer(0.1, self.beat, GROUP)

    def grab(self):
        self.frames.publish(Int32())

    def on_frame(self, message):
        time.sleep(0.6)

    def beat(self):
        pass

rclpy.init()
executor = MultiThreadedExecutor(num_threads=3)
executor.add_node(Detector())
executor.spin()
"""


def test_what_was_an_effect_of_another_problem_before_is_not_new(tmp_path: Path) -> None:
    runs = []
    for group in ("None", "MutuallyExclusiveCallbackGroup()"):
        (tmp_path / "camera.py").write_text(CAMERA.replace("GROUP", group))
        runs.append(run_to_end(program_setup(tmp_path / "camera.py", 8.0)).timeline)
    assert told(*runs) == "Gone in run B: wait for a group. Still in run B: dropped messages."


def test_nothing_is_said_of_a_run_that_has_not_come_to_the_problem() -> None:
    early = run_of("sleep_in_service", seconds=0.2)
    for stuck in (run_of("call_in_timer"), run_of("held_group")):
        assert told(stuck, early) == ""
        assert told(early, stuck) == ""


def test_of_runs_that_were_not_given_the_same_commands_nothing_is_gone_or_new() -> None:
    called = run_lesson("exclusive-2-threads", 12.0, 2.0, 3.0, threads=1).timeline
    uncalled = run_lesson("exclusive-2-threads", 12.0, threads=1).timeline
    again = run_lesson("exclusive-2-threads", 12.0, 2.0, 3.0).timeline
    assert told(called, uncalled) == ""
    assert speaks(called, uncalled) is None
    assert told(called, again) == "Gone in run B: no free thread."


def test_of_programs_that_share_little_neither_is_better_and_each_has_its_own_problems() -> None:
    starved, stuck = run_of("held_group"), run_of("call_in_timer")
    compared = compare(starved, stuck, Window(0, starved.end))
    told = headline(compared, ComparedProblems(starved, stuck).compared(compared))
    found = "Found in run A: wait for a group. Found in run B: deadlock. "
    shared = "The runs share none of 5 callbacks: too little in common for one to be better."
    assert told == found + shared
    assert not is_tie(compared)
