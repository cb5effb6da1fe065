"""Threads that stand still in a call of a service are told, with where and for what."""

from sim.trace import events as ev
from sim.trace.model import Blocked, Window
from sim.trace.timeline import Timeline
from tests.support.runs import Run, ns

ALWAYS = Window(0, ns(100.0))


def timeline_of(run: Run) -> Timeline:
    timeline = Timeline()
    timeline.extend(run.events)
    return timeline


def calling_run() -> tuple[Run, int, int]:
    """A run whose timer's callback, from 1 s to 6 s, stands in a call from 2 s to 5 s; thread and timer."""
    run = Run()
    thread = run.thread("MainThread")
    timer = run.timer(run.exclusive(run.node("/node")), "on_timer", 1.0)
    run.callback(timer, thread, 1.0, 5.0)
    call = run.call("/turn", 2.0, replied=5.0, entity=timer)
    run.blocked(call, "/turn", thread, timer, 2.0, until=5.0)
    return run, thread, timer


def test_a_moment_tells_who_stands_where_and_for_what() -> None:
    run, thread, timer = calling_run()
    timeline = timeline_of(run)
    blocked = Blocked(ns(2.0), ns(5.0), thread, timer, 1, "/turn")
    assert timeline.moment(ns(2.0)).blocked == {thread: blocked}
    assert timeline.moment(ns(4.9)).blocked == {thread: blocked}
    assert not timeline.moment(ns(1.9)).blocked
    assert not timeline.moment(ns(5.0)).blocked


def test_a_window_tells_the_stretches_that_share_time_with_it() -> None:
    run, thread, _ = calling_run()
    timeline = timeline_of(run)
    assert [each.start for each in timeline.blocks_on(thread, Window(ns(4.0), ns(4.5)))] == [ns(2.0)]
    assert not timeline.blocks_on(thread, Window(ns(5.0), ns(9.0)))
    assert not timeline.blocks_on(thread + 1, ALWAYS)


def test_start_and_end_of_standing_still_are_neighbours_of_the_callback_that_calls() -> None:
    run, _, _ = calling_run()
    timeline = timeline_of(run)
    steps = [ns(1.0)]
    while (later := timeline.neighbour(steps[-1], 1)) is not None:
        steps.append(later)
    assert steps == [ns(1.0), ns(2.0), ns(5.0), ns(6.0)]
    assert timeline.neighbour(ns(6.0), -1) == ns(5.0)


def test_a_call_outside_of_callbacks_is_a_neighbour_among_all_events() -> None:
    run = Run()
    thread = run.thread("MainThread")
    run.blocked(run.call("/turn", 2.0), "/turn", thread, 0, 2.0, until=5.0)
    timeline = timeline_of(run)
    assert [each.entity for each in timeline.moment(ns(3.0)).blocked.values()] == [0]
    assert timeline.neighbour(ns(3.0), 1) == ns(5.0)
    assert timeline.neighbour(ns(3.0), -1) == ns(2.0)


def test_a_call_that_never_returns_lasts() -> None:
    run, thread, timer = calling_run()
    run.blocked(run.call("/turn", 5.5), "/turn", thread, timer, 5.5)
    last = timeline_of(run).blocks_on(thread, ALWAYS)[-1]
    assert (last.start, last.end) == (ns(5.5), None)


def test_a_thread_that_runs_another_callback_stands_still_no_longer() -> None:
    timeline = Timeline()
    timeline.extend([ev.CallBlocked(1, 1, 1, 5, "/turn"), ev.CallbackStarted(9, 6, 1, 0, 0, 0)])
    assert [(each.start, each.end) for each in timeline.blocks_on(1, ALWAYS)] == [(1, 9)]


def test_the_return_of_another_call_than_the_thread_stands_in_is_passed_over() -> None:
    timeline = Timeline()
    timeline.extend(
        [ev.CallBlocked(1, 1, 1, 5, "/turn"), ev.CallUnblocked(3, 2, 1), ev.CallUnblocked(4, 1, 2)]
    )
    assert [each.end for each in timeline.blocks_on(1, ALWAYS)] == [None]
