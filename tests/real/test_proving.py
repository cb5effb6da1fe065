"""What counts as a difference between the model and real rclpy, and what does not."""

import random
import re
from collections.abc import Callable
from pathlib import Path

import pytest

from cbtui import cli
from cbtui.commands.options import changes
from cbtui.commands.prove import _told
from cbtui.runs.compared_runs import ComparedSide, RunPair
from cbtui.runs.judged.proving import differences
from sim.trace.events import EntityId, ThreadId
from sim.trace.model import Window
from sim.trace.timeline import Timeline
from tests.real.programs import needs_ros
from tests.support.runs import Run, ns

SECONDS = 10.0


class Ticking:
    """A run of a node: a timer ticks five times a second, a subscription hears ten messages a second.

    ``shift`` is how much later all of that comes, ``heard_from`` when the subscription hears something first;
    each start comes up to ``jitter`` late. From ``busy`` on, for three seconds, neither runs.
    """

    def __init__(
        self,
        shift: float = 0.0,
        heard_from: float = 0.0,
        jitter: float = 0.0,
        busy: tuple[EntityId, ...] = (),
        until: float = SECONDS,
    ) -> None:
        self.run = run = Run()
        self.thread: ThreadId = run.thread("MainThread")
        run.executor("SingleThreadedExecutor", 1)
        group = self.group = run.exclusive(run.node("/n"))
        self.tick = run.timer(group, "tick", 0.2)
        self.hear = run.subscription(group, "/news", "hear")
        chance = random.Random(1)
        for entity, period, first in ((self.tick, 0.2, 0.2), (self.hear, 0.1, max(heard_from, 0.13))):
            at = first + shift
            while at < until:
                if entity not in busy or not 4.0 <= at < 7.0:
                    late = chance.random() * jitter
                    run.callback(entity, self.thread, at + late, 0.001, late=late)
                at += period

    def timeline(self, ends: Callable[[Run], object] = lambda run: run.over(SECONDS)) -> Timeline:
        """The run as a timeline, when it is over."""
        ends(self.run)
        timeline = Timeline()
        timeline.extend(self.run.events)
        return timeline


def told(model: Ticking, real: Ticking) -> list[str]:
    """What differs between two runs."""
    found = differences(model.timeline(), real.timeline(), Window(0, ns(SECONDS)))
    return [each.what for each in found]


@pytest.mark.parametrize(
    "real",
    [
        Ticking(),
        Ticking(shift=0.15),
        Ticking(jitter=0.045),
        Ticking(heard_from=1.7),
        Ticking(until=9.75),
    ],
    ids=["alike", "shifted", "jitter", "found late", "one call less"],
)
def test_what_a_machine_brings_about_is_no_difference(real: Ticking) -> None:
    assert told(Ticking(), real) == []


def test_a_time_in_which_a_callback_runs_on_one_ground_alone_is_told_with_its_reason() -> None:
    model, real = Ticking(), Ticking(busy=(2,))
    real.run.wait(real.hear, since=4.0, until=7.0, holder=real.tick)
    why = "(group A held by tick)"
    assert told(model, real)[:2] == [
        f"on real rclpy hear does not run for 3.1 s from 3.9 s on {why}, on the model it does",
        "the diagnosis finds on real rclpy alone: hear waited 3.0 s: group A was held by tick",
    ]


def test_which_of_several_waited_longest_for_the_same_is_no_difference() -> None:
    model, real = Ticking(busy=(1, 2)), Ticking(busy=(1, 2))
    for ran, since in ((model, (4.0, 4.02)), (real, (4.02, 4.0))):
        keep = ran.run.timer(ran.group, "keep", 9.0)
        ran.run.callback(keep, ran.thread, 4.0, 3.0)
        for entity, at in zip((ran.tick, ran.hear), since, strict=True):
            ran.run.wait(entity, at, 7.0, holder=keep)
    assert told(model, real) == []


def test_more_calls_are_told() -> None:
    model, real = Ticking(), Ticking()
    for place in range(4):
        real.run.callback(real.tick, real.thread, 2.25 + place, 0.001)
    assert told(model, real) == ["on real rclpy tick runs 4 times more: 53 against 49 on the model"]


def test_a_callback_that_never_runs_is_told() -> None:
    said = "on real rclpy hear never runs, on the model it does (99 calls)"
    assert told(Ticking(), Ticking(heard_from=99)) == [said]


def test_a_call_that_does_not_return_is_told_and_what_follows_from_it_is_not() -> None:
    model, real = Ticking(until=5.0), Ticking(until=5.0)
    model.run.callback(model.tick, model.thread, 5.0, 2.0)
    real.run.callback(real.tick, real.thread, 5.0)
    assert told(model, real) == [
        "on real rclpy tick does not return from its call at 5.0 s, on the model it does"
    ]


def test_errors_and_ends_are_told() -> None:
    model, real = Ticking(until=9.9), Ticking(until=9.9)
    real.run.start(real.tick, real.thread, 9.95)
    real.run.fail(real.tick, real.thread, 9.96, "ValueError: no")
    reason = "node.py:1: the program raised ValueError: no"
    failed = real.timeline(lambda run: run.over(9.97, reason, failed=True))
    found = differences(model.timeline(), failed, Window(0, ns(9.97)))
    assert [each.what for each in found][:2] == [
        "tick: on the model it raises nothing, on real rclpy it raises ValueError: no",
        f"the run ends on the model: its time was up; on real rclpy: {reason}",
    ]


def test_one_call_is_not_said_to_be_several() -> None:
    run = Run()
    run.callback(run.timer(run.exclusive(run.node("/n")), "tick", 1.0), run.thread("MainThread"), 1.0, 0.1)
    timeline = Timeline()
    timeline.extend(run.events)
    pair = RunPair(
        ComparedSide("the model", timeline), ComparedSide("real rclpy", timeline), Window(0, ns(2.0))
    )
    assert _told(pair, []) == "✓ the same on both for 2 s: 1 call on the model, 1 on real rclpy\n"


def test_other_log_lines_are_told_and_other_numbers_are_not() -> None:
    model, real = Ticking(), Ticking()
    for run, number, last in ((model, 0.51, "left"), (real, 0.49, "right")):
        run.run.log(f"the wall is {number} m off", 1.0, run.thread, run.tick)
        run.run.log(f"turn {last}", 2.0, run.thread, run.tick)
    assert told(model, real) == [
        "tick logs 'turn left' on the model where it logs 'turn right' on real rclpy"
    ]


def test_the_order_in_which_a_thread_serves_what_it_kept_waiting_is_told() -> None:
    model, real = Ticking(until=5.0), Ticking(until=5.0)
    for run, order in ((model, (1, 2)), (real, (2, 1))):
        for place, entity in enumerate(order):
            run.run.wait(entity, since=6.0, until=7.0 + 0.001 * place, holder=run.tick)
            run.run.callback(entity, run.thread, 7.0 + 0.001 * place, 0.001)
    said = "what has waited runs in another order: on the model tick, hear; on real rclpy hear, tick"
    assert said in told(model, real)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["nothing"], "no lesson is called 'nothing'"),
        (["no.py"], "there is no file no.py"),
        (["single-thread", "--", "-x"], "a lesson has its own arguments"),
        (["single-thread", "--for", "5", "--call", "6"], "a call at 6 s comes when the run of 5 s is over"),
        (["single-thread", "--python", "/no/python3"], "--python /no/python3: there is no such program"),
        (["single-thread"], "has no rclpy; name a Python that has it with --python"),
    ],
)
def test_what_cannot_be_proved_is_refused_in_a_sentence(
    words: list[str], said: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(changes, "_wheels_of", lambda _: None)
    with pytest.raises(SystemExit) as ended:
        cli.main(["prove", *words])
    told = capsys.readouterr()
    assert (ended.value.code, told.out) == (2, "")
    assert said in told.err
    assert len(told.err.splitlines()) == 1


DIFFERS = """
import rclpy
from rclpy.node import Node

rclpy.init()
node = Node("n")
node.create_timer(0.2 if "sim" in rclpy.__file__ else 0.5, lambda: None)
try:
    rclpy.spin(node)
except KeyboardInterrupt:
    pass
"""


@needs_ros
@pytest.mark.slow
def test_a_program_is_proved_on_both_grounds(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "node.py"
    file.write_text(DIFFERS)
    assert cli.main(["prove", str(file), "--for", "3.3", "--no-robot"]) == 1
    # A busy machine may let a call on real rclpy fall out.
    said = capsys.readouterr().out
    assert re.search(r"on the model <lambda>:7 runs 1[0-3] times more: 16 against [3-6]\b", said)
    file.write_text(DIFFERS.replace("0.2", "0.5"))
    assert cli.main(["prove", str(file), "--for", "3.3", "--no-robot"]) == 0
    said = capsys.readouterr().out
    assert re.search(r"✓ the same on both for 3\.3 s: 6 calls on the model, [56] on real rclpy", said)


@needs_ros
@pytest.mark.slow
def test_a_lesson_that_real_ros_cannot_show_says_why(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["prove", "one-queue-for-all", "--for", "3", "--no-robot"]) == 1
    said = capsys.readouterr().out
    assert (
        "On real ROS 2 this lesson cannot be judged: spin() of the EventsExecutor runs no callbacks" in said
    )
