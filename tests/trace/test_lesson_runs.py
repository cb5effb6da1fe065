"""The hand-made runs of the lessons are legal: what the tests of widgets stand on."""

from collections.abc import Callable
from itertools import pairwise

import pytest

from sim.trace.events import GroupKind
from sim.trace.model import Window
from sim.trace.timeline import Timeline
from tests.support.runs import (
    Run,
    dummy_server_one_thread_run,
    dummy_server_run,
    ns,
    shared_group_run,
    split_groups_run,
)

RUNS = (shared_group_run, split_groups_run, dummy_server_run, dummy_server_one_thread_run)
every_run = pytest.mark.parametrize("make", RUNS)


def timeline_of(run: Run) -> Timeline:
    timeline = Timeline()
    timeline.extend(run.events)
    return timeline


@every_run
def test_events_come_in_order_of_time(make: Callable[[], Run]) -> None:
    assert all(first.t <= second.t for first, second in pairwise(make().events))


@every_run
def test_calls_on_a_thread_and_in_an_exclusive_group_follow_each_other(make: Callable[[], Run]) -> None:
    timeline = timeline_of(make())
    whole = Window(0, timeline.end + 1)
    exclusive = [group.id for group in timeline.groups.values() if group.kind is GroupKind.EXCLUSIVE]
    threads = [timeline.spans_on(thread, whole) for thread in timeline.threads]
    for lane in (*threads, *(timeline.spans_in(group, whole) for group in exclusive)):
        assert all(first.end_at(timeline.end) <= second.start for first, second in pairwise(lane))


@every_run
def test_nothing_is_left_queued_for_long_at_the_end(make: Callable[[], Run]) -> None:
    timeline = timeline_of(make())
    assert all(queue.depth <= 1 for queue in timeline.moment(timeline.end).queues.values())


def test_a_run_is_cut_where_asked() -> None:
    run = shared_group_run(14.25)
    assert timeline_of(run).end == ns(14.25)
    assert run.until(14.25) == run.events


def test_odom_and_scan_go_on_while_the_split_groups_rotate() -> None:
    timeline = timeline_of(split_groups_run())
    _, odom, scan = timeline.entities
    rotation = Window(ns(4.0), ns(14.0))
    assert timeline.calls_of(odom, rotation) == timeline.calls_of(scan, rotation) == 200
    assert timeline.dropped(timeline.end) == 0


def test_the_timer_ticks_through_the_call_on_the_other_of_two_threads_only() -> None:
    during = Window(ns(2.55), ns(7.55))
    two, one = timeline_of(dummy_server_run()), timeline_of(dummy_server_one_thread_run())
    assert [span.start for span in two.spans_of(2, during)] == [ns(second) for second in range(3, 8)]
    assert {span.thread for span in two.spans_of(2, during)} == {2}
    assert not one.spans_of(2, during)
