"""What the DummyServer lessons must show: who ticks while the service is busy."""

import pytest

from sim.trace.events import Printed, Reason, ServiceReplied, VelocityCommanded
from sim.trace.model import Window
from tests.support.engine_runs import SECOND, Run, run_lesson

TWO_THREADS = ("exclusive-2-threads", "reentrant-2-threads")


def _ticks(run: Run) -> list[float]:
    return [at for at, text in run.logs() if text in {"TICK", "TACK"}]


def _threads_of(run: Run, callback: str, begin: float, end: float) -> set[str]:
    timeline = run.timeline
    entity = next(each for each in timeline.entities.values() if each.callback == callback)
    spans = timeline.spans_of(entity.id, Window(round(begin * SECOND), round(end * SECOND)))
    return {timeline.threads[span.thread].name for span in spans}


@pytest.mark.parametrize("lesson", TWO_THREADS)
def test_with_two_threads_the_timer_ticks_on_beside_the_call(lesson: str) -> None:
    run = run_lesson(lesson, 10, 2.55)
    assert _ticks(run) == [1, 2, 3, 4, 5, 6, 7, 8, 9]
    [server] = _threads_of(run, "SetBool_callback", 2.5, 7.6)
    [ticker] = _threads_of(run, "timer_callback", 2.9, 7.1)
    assert server != ticker


def test_with_one_thread_the_timer_waits_for_the_call_to_end() -> None:
    run = run_lesson("reentrant-1-thread", 10, 2.55)
    assert _ticks(run) == [1, 2, 7.55, 8, 9]
    timeline = run.timeline
    timer = next(each for each in timeline.entities.values() if each.callback == "timer_callback")
    [wait] = timeline.waits_of(timer.id, Window(0, timeline.end))
    assert wait.reason is Reason.NO_FREE_WORKER
    assert timeline.entities[wait.holder].callback == "SetBool_callback"
    assert (wait.since, wait.end) == (3 * SECOND, round(7.55 * SECOND))


@pytest.mark.parametrize("lesson", [*TWO_THREADS, "reentrant-1-thread"])
def test_the_reply_comes_after_five_seconds_and_says_turning(lesson: str) -> None:
    run = run_lesson(lesson, 10, 2.55)
    [reply] = [event for event in run.events if isinstance(event, ServiceReplied)]
    assert reply.t == round(7.55 * SECOND)
    assert "message='TURNING'" in reply.response


@pytest.mark.parametrize("lesson", [*TWO_THREADS, "reentrant-1-thread"])
def test_the_robot_turns_during_the_call_and_stands_after_it(lesson: str) -> None:
    run = run_lesson(lesson, 10, 2.55)
    commands = [event for event in run.events if isinstance(event, VelocityCommanded)]
    assert [event.t for event in commands] == [round(2.55 * SECOND), round(7.55 * SECOND)]
    assert commands[0].angular != 0
    assert (commands[-1].linear, commands[-1].angular) == (0, 0)
    robot = run.timeline.robot(10 * SECOND)
    assert robot is not None
    assert abs(robot.turned) > 0.5


@pytest.mark.slow
def test_three_calls_at_once_use_both_threads_of_a_reentrant_group() -> None:
    run = run_lesson("reentrant-2-threads", 16, 2.55, 2.55, 2.55)
    assert _ticks(run) == [1, 2, 7.55, 8, 9, 10, 11, 12, 13, 14, 15]


@pytest.mark.slow
def test_three_calls_at_once_are_served_one_by_one_in_an_exclusive_group() -> None:
    run = run_lesson("exclusive-2-threads", 20, 2.55, 2.55, 2.55)
    assert _ticks(run) == [float(second) for second in range(1, 20)]
    replies = [event.t / SECOND for event in run.events if isinstance(event, ServiceReplied)]
    assert replies == [7.55, 12.55, 17.55]


def test_one_thread_in_a_multi_threaded_executor_is_warned_about() -> None:
    run = run_lesson("reentrant-1-thread", 10, 2.55)
    printed = [event.text for event in run.events if isinstance(event, Printed)]
    assert "UserWarning: MultiThreadedExecutor is used with a single thread." in printed[0]
    assert printed[1] == "Use the SingleThreadedExecutor instead."


def test_the_number_of_threads_can_be_chosen() -> None:
    run = run_lesson("reentrant-1-thread", 10, 2.55, threads=2)
    assert _ticks(run) == [1, 2, 3, 4, 5, 6, 7, 8, 9]
    assert "DummyServer Started with threads=2" in [text for _, text in run.logs()]
