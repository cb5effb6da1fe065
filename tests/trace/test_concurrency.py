import pytest

from sim.trace.events import AnyEvent
from sim.trace.figures.concurrency import Concurrency
from sim.trace.timeline import Timeline
from tests.support.builder import Run, ns
from tests.support.runs import dummy_server_run, shared_group_run, split_groups_run


def peak(run: Run, at: float) -> int:
    return Concurrency(timeline_of(run.events)).peak(ns(at))


def timeline_of(events: list[AnyEvent]) -> Timeline:
    timeline = Timeline()
    timeline.extend(events)
    return timeline


def two_threads() -> tuple[Run, int, int, int]:
    run = Run()
    first, second = (run.thread(f"ThreadPoolExecutor-0_{number}") for number in range(2))
    timer = run.timer(run.reentrant(run.node("/n")), "tick", 1.0)
    return run, timer, first, second


def test_one_thread_is_needed_once_at_a_time() -> None:
    assert peak(shared_group_run(), 30.0) == 1


def test_a_sensor_beside_a_long_call_needs_a_second_thread() -> None:
    assert peak(split_groups_run(), 3.9) == 1
    assert peak(split_groups_run(), 4.1) == 2
    assert peak(dummy_server_run(), 10.0) == 2


def test_nothing_is_needed_before_the_first_call() -> None:
    assert peak(split_groups_run(), 0.0) == 0


def test_a_call_that_begins_as_another_ends_is_not_at_once() -> None:
    run, timer, first, second = two_threads()
    run.callback(timer, first, 1.0, 1.0)
    run.callback(timer, second, 2.0, 1.0)
    assert peak(run, 5.0) == 1


def test_calls_without_length_at_one_instant_are_not_at_once() -> None:
    run, timer, first, second = two_threads()
    run.callback(timer, first, 1.0, 0.0)
    run.callback(timer, second, 1.0, 0.0)
    assert peak(run, 5.0) == 1


def test_a_call_without_length_needs_a_thread_beside_a_longer_one() -> None:
    run, timer, first, second = two_threads()
    run.callback(timer, first, 1.0, 2.0)
    run.callback(timer, second, 2.0, 0.0)
    assert peak(run, 1.5) == 1
    assert peak(run, 2.0) == 2


def test_calls_nested_on_one_thread_need_one_thread() -> None:
    run, timer, first, _ = two_threads()
    run.callback(timer, first, 1.0, 2.0)
    run.callback(timer, first, 1.5, 0.5)
    assert peak(run, 5.0) == 1


def test_a_run_that_grows_in_batches_gives_the_same_peaks() -> None:
    events = split_groups_run().events
    whole = Concurrency(timeline_of(events))
    timeline = Timeline()
    grown = Concurrency(timeline)
    for start in range(0, len(events), 97):
        timeline.extend(events[start : start + 97])
        grown.peak(timeline.end)
    moments = [ns(tenth / 10) for tenth in range(200)]
    assert [grown.peak(at) for at in moments] == [whole.peak(at) for at in moments]


@pytest.mark.parametrize("took", [0.0, 0.5])
def test_a_reply_that_a_blocked_call_waits_for_needs_a_second_thread(took: float) -> None:
    run, timer, first, second = two_threads()
    reply = run.client(run.exclusive(run.node("/m")), "/s", "reply")
    run.callback(timer, first, 1.0, took)
    run.blocked(run.call("/s", 1.0, 1.0 + took), "/s", first, timer, 1.0, 1.0 + took)
    assert peak(run, 5.0) == 1
    run.callback(reply, second, 1.0 + took, 0.0)
    assert peak(run, 5.0) == 2
