"""Two runs side by side: callbacks are matched by what they are, and figures are of the window only."""

from sim.trace.comparison import compare
from sim.trace.comparison_text import comparison_text
from sim.trace.events import (
    AnyEvent,
    CallbackEnded,
    CallbackStarted,
    EntityAppeared,
    EntityKind,
    GroupAppeared,
    GroupKind,
    MessageDropped,
    NodeAppeared,
    Reason,
    RobotMoved,
    RunStarted,
    ThreadAppeared,
    WaitEnded,
    WaitStarted,
)
from sim.trace.model import Window
from sim.trace.timeline import Timeline
from tests.support.builder import ns

ODOM, TIMER = "odom_callback", "timer_callback"


def run(callbacks: list[str], events: list[AnyEvent]) -> Timeline:
    """A run whose entities 1, 2, … have these callbacks, in one group and on one thread."""
    timeline = Timeline()
    cast: list[AnyEvent] = [
        RunStarted(0, "run", "virtual", 0),
        ThreadAppeared(0, 1, "MainThread"),
        NodeAppeared(0, 1, "/node"),
        GroupAppeared(0, 1, 1, GroupKind.EXCLUSIVE, "MutuallyExclusiveCallbackGroup"),
    ]
    for number, callback in enumerate(callbacks, start=1):
        kind = EntityKind.TIMER if callback == TIMER else EntityKind.SUBSCRIPTION
        name, depth, period = ("", 0, ns(1.0)) if callback == TIMER else ("/odom", 10, 0)
        cast.append(EntityAppeared(0, number, 1, 1, kind, name, callback, "node.py", 1, 2, depth, period))
    timeline.extend([*cast, *events])
    return timeline


def called(entity: int, start: float, end: float, age: float = 0.0) -> list[AnyEvent]:
    return [CallbackStarted(ns(start), entity, 1, 0, ns(age), 0), CallbackEnded(ns(end), entity, 1)]


def starved() -> Timeline:
    """The timer's callback keeps odom's waiting from 1 to 3 s, and two messages are lost."""
    return run(
        [ODOM, TIMER],
        [
            *called(2, 0.5, 0.6)[:1],
            WaitStarted(ns(1.0), 1, ns(1.0), Reason.GROUP_HELD, 2, False),
            MessageDropped(ns(2.0), 1, 10, 5),
            MessageDropped(ns(2.5), 1, 10, 6),
            CallbackEnded(ns(3.0), 2, 1),
            WaitEnded(ns(3.0), 1),
            *called(1, 3.0, 3.1, age=2.0),
        ],
    )


def healthy() -> Timeline:
    """The same callbacks, made in the other order."""
    return run(
        [TIMER, ODOM], [*called(2, 1.0, 1.1, age=0.1), *called(2, 2.0, 2.1, age=0.2), *called(1, 3.0, 3.2)]
    )


def test_callbacks_match_by_what_they_are_and_not_by_their_numbers() -> None:
    compared = compare(starved(), healthy(), Window(0, ns(4.0)))
    calls = {
        pair.name: (pair.first and pair.first.figures.calls, pair.second and pair.second.figures.calls)
        for pair in compared.callbacks
    }
    assert calls == {ODOM: (1, 2), TIMER: (1, 1)}


def test_a_callback_of_one_run_only_stands_alone() -> None:
    compared = compare(starved(), run([TIMER], called(1, 1.0, 1.1)), Window(0, ns(4.0)))
    (odom,) = (pair for pair in compared.callbacks if pair.name == ODOM)
    assert odom.first is not None
    assert odom.second is None


def test_waits_and_drops_count_as_far_as_they_lie_in_the_window() -> None:
    compared = compare(starved(), healthy(), Window(ns(1.5), ns(2.2)))
    (odom,) = (pair for pair in compared.callbacks if pair.name == ODOM)
    assert odom.first is not None
    assert odom.first.waits is not None
    assert (odom.first.waits.longest, odom.first.waits.total) == (ns(0.7), ns(0.7))
    assert odom.first.waits.why == "group A held by timer_callback"
    assert odom.first.figures.drops == 1


def test_what_the_robot_travelled_counts_from_the_windows_beginning() -> None:
    def moved(t: float, travelled: float) -> RobotMoved:
        return RobotMoved(ns(t), travelled, 0.0, 0.0, 1.0, 0.1, 0.0, True, False, 0.0, travelled)

    timeline = run([], [moved(0.0, 0.0), moved(1.0, 0.5), moved(2.0, 0.75), moved(3.0, 1.0)])
    compared = compare(timeline, timeline, Window(ns(1.0), ns(2.5)))
    assert compared.first.robot is not None
    assert compared.first.robot.travelled == 0.25


def test_two_runs_as_text_side_by_side() -> None:
    text = comparison_text(compare(starved(), healthy(), Window(0, ns(4.0))), "starved", "healthy")
    assert (
        text
        == """\
A  starved
B  healthy
from 0 s to 4 s

                      A                            B
threads               1 used, 1 at once            1 used, 1 at once

odom_callback
  calls               1                            2
  longest wait        2.0 s                        -
  waits in all        2.0 s                        -
  drops               2                            0
  data age            2.0 s, at most 2.0 s         100 ms, at most 200 ms
  A waits: group A held by timer_callback

timer_callback
  calls               1                            1
  late                0 s, at most 0 s             0 s, at most 0 s
"""
    )
    assert max(map(len, text.splitlines())) <= 80
