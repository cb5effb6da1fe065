"""What trace viewers are told of a run, read back from both kinds of file."""

from collections.abc import Callable, Sequence

import pytest
from hypothesis import given

from sim.trace.events import (
    AnyEvent,
    CallbackStarted,
    EntityAppeared,
    EntityReady,
    GroupAppeared,
    NodeAppeared,
    Published,
    Reason,
    RunStarted,
    ThreadAppeared,
    kinds,
)
from sim.trace.model import Window
from tests.export import reading
from tests.export.examples import NASTY, small_run, timeline_of
from tests.export.reading import Trace
from tests.support.runs import Run, dummy_server_run, ns, shared_group_run
from tests.trace.samples import CAST, FULL, full
from tests.trace.systems import GROUP_OF, THREADS, jumbled_runs, legal_runs

Read = Callable[[Sequence[AnyEvent]], Trace]
both = pytest.mark.parametrize("read", [reading.perfetto, reading.chrome])


def assert_sound(trace: Trace) -> None:
    """Slices balanced and nested, times in order, flows paired."""
    assert not any(trace.open.values())
    assert trace.times == sorted(trace.times)
    for flow, ends in trace.ended.items():
        assert len(ends) == 1
        assert trace.begun[flow][0][0] <= ends[0][0]
    assert trace.begun.keys() == trace.ended.keys()
    for slices in trace.slices.values():
        assert all(slice_.end is not None and slice_.end >= slice_.start for slice_ in slices)


@both
@pytest.mark.parametrize("run", [small_run, shared_group_run, dummy_server_run])
def test_slices_are_balanced_times_in_order_and_flows_paired(
    read: Read, run: Callable[[], Run | list[AnyEvent]]
) -> None:
    made = run()
    assert_sound(read(made.events if isinstance(made, Run) else made))


@both
@given(runs=jumbled_runs())
def test_so_they_are_for_whatever_run(read: Read, runs: tuple[list[AnyEvent], list[AnyEvent]]) -> None:
    assert_sound(read(runs[1]))


@given(legal_runs())
def test_a_threads_slices_are_the_spans_and_the_blocked_stretches_of_the_timeline(
    events: list[AnyEvent],
) -> None:
    timeline, trace = timeline_of(events), reading.perfetto(events)
    for thread in THREADS:
        tracks = trace.named(f"worker {thread}")
        told = [(s.name, s.start, s.end) for track in tracks for s in trace.slices[track]]
        known = [
            (timeline.entities[span.entity].spoken_name, span.start, span.end_at(timeline.end))
            for span in timeline.spans_on(thread, Window(0, timeline.end + 1))
        ]
        known += [
            (
                f"blocked in a call of {block.service}",
                block.start,
                timeline.end if block.end is None else block.end,
            )
            for block in timeline.blocks_on(thread, Window(0, timeline.end + 1))
        ]
        assert sorted(told) == sorted(known)


@given(legal_runs())
def test_an_entitys_slices_are_its_waits(events: list[AnyEvent]) -> None:
    timeline, trace = timeline_of(events), reading.perfetto(events)
    for entity in GROUP_OF:
        [*tracks] = trace.named(f"callback{entity} (/topic{entity})")
        told = [(s.start, s.end, s.facts["reason"]) for track in tracks for s in trace.slices[track]]
        known = []
        over = 0
        for wait in timeline.waits_of(entity, Window(0, timeline.end + 1)):
            # Waits of an entity do not overlap in a viewer, even if it became ready before its last call.
            start, over = max(wait.start, over), timeline.end if wait.end is None else wait.end
            known.append((start, over, wait.reason.value))
        assert sorted(told) == sorted(known)


@both
def test_threads_are_named_as_rclpy_names_them_and_lie_in_their_process(read: Read) -> None:
    trace = read(small_run())
    [process] = trace.named("small run")
    for name in ("MainThread", "ThreadPoolExecutor-0_0"):
        [thread] = trace.named(name)
        assert trace.parents[thread] == process


@both
def test_groups_are_tracks_and_hold_their_calls_from_beginning_to_end(read: Read) -> None:
    trace = read(small_run())
    [group] = trace.named("C exclusive /sub_node")
    later, suspended, nasty = trace.slices[group]
    assert (later.name, later.start, later.end) == ("later", ns(1.0), ns(1.8))
    assert (suspended.name, suspended.start, suspended.end) == ("suspended", ns(1.1), ns(1.6))
    assert nasty.facts["unfinished"] == "yes"


@both
def test_a_call_tells_its_topic_age_queue_and_error(read: Read) -> None:
    trace = read(small_run())
    [thread] = trace.named("MainThread")
    odom = trace.slices[thread][0]
    expected = {"entity": "subscription", "topic": "/odom", "group": "A", "queue_depth": 0}
    assert expected.items() <= odom.facts.items()
    assert odom.facts["message_age_ms"] == pytest.approx(10)
    failed = trace.slices[thread][-2]
    assert failed.facts["error"] == "IndexError: no beam 720 | `x`"
    assert failed.facts["late_ms"] == pytest.approx(100)
    assert failed.facts["waited_ms"] == pytest.approx(100)


@both
def test_standing_still_in_a_call_is_a_slice_within_the_callback(read: Read) -> None:
    trace = read(small_run())
    [thread] = trace.named("MainThread")
    blocked = [s for s in trace.slices[thread] if s.name == "blocked in a call of /motor_power"]
    assert [(s.start, s.end, s.depth) for s in blocked] == [(ns(1.25), ns(1.4), 1), (ns(2.0), ns(2.5), 0)]


@both
def test_a_wait_tells_reason_and_culprit(read: Read) -> None:
    trace = read(small_run())
    [odom] = trace.named("odom_callback (/odom)")
    [wait] = trace.slices[odom]
    assert (wait.name, wait.start, wait.end) == ("group A held by timer_callback", ns(0.6), ns(1.5))
    assert (wait.facts["reason"], wait.facts["culprit"]) == ("group held", "timer_callback")
    assert [name for _, name in trace.instants[odom]] == ["lost", "still in the queue"]


@both
def test_a_wait_begins_when_its_callback_became_ready(read: Read) -> None:
    run = Run()
    main, node = run.thread("MainThread"), run.node("/n")
    odom = run.subscription(run.exclusive(node), "/odom", "odom_callback")
    run.message(odom, 1.0)
    run.wait_changes(odom, at=1.3, since=1.0, reason=Reason.NOBODY_SPINS)
    run.log("later", 1.2, main)
    run.over(4.0)
    trace = read(run.events)
    [track] = trace.named("odom_callback (/odom)")
    assert [(s.start, s.end) for s in trace.slices[track]] == [(ns(1.0), ns(4.0))]
    assert_sound(trace)


def test_a_message_has_an_arrow_to_each_callback_that_takes_it() -> None:
    run = Run()
    main, node = run.thread("MainThread"), run.node("/n")
    subscriptions = [run.subscription(run.exclusive(node), "/odom", name) for name in ("first", "second")]
    message = run.message(subscriptions[0], 1.0)
    run.add(EntityReady(ns(1.0), subscriptions[1], 1, message))
    run.callback(subscriptions[0], main, 1.0, 0.1)
    run.add(CallbackStarted(ns(1.2), subscriptions[1], main, message, ns(0.2), 0))
    run.end(subscriptions[1], main, 1.3)
    trace = reading.perfetto(run.events)
    assert [[name for _, _, name in each] for each in trace.begun.values()] == [["publish /odom"]] * 2
    assert [each[0][2] for each in trace.ended.values()] == ["first", "second"]


def test_a_call_has_an_arrow_through_the_service_to_its_reply_and_on_to_the_client() -> None:
    trace = reading.perfetto(small_run())
    ways = {tuple(name for _, _, name in [*trace.begun[flow], *trace.ended[flow]]) for flow in trace.ended}
    assert ("call /motor_power", "serve", "reply /motor_power") in ways
    assert ("call /motor_power", "serve") in ways
    assert ("reply /motor_power", "answered") in ways
    assert ("call /motor_power", "calls without a reply") in ways


@both
def test_queues_and_the_robot_are_counters(read: Read) -> None:
    trace = reading.perfetto(small_run())
    [queue] = trace.named("queue of odom_callback")
    values = [value for _, value in trace.counts[queue]]
    assert values == [1, 0, 1, 0, 1]
    [velocity] = trace.named("commanded linear velocity")
    assert trace.counts[velocity] == [(ns(0.1), 0.08)]
    assert sum(map(len, read(small_run()).counts.values())) == sum(map(len, trace.counts.values()))


@both
def test_log_lines_and_commands_are_instants_and_cannot_break_out(read: Read) -> None:
    trace = read(small_run())
    [log] = trace.named("log")
    clean = NASTY.replace("\x1b", "�").replace("\x00", "�")
    assert trace.instants[log] == [(ns(1.3), clean), (ns(1.3), "(empty line)")]
    [commands] = trace.named("commands")
    assert trace.instants[commands] == [(ns(1.9), "/motor_power true")]


@both
def test_calls_at_once_of_a_group_lie_on_tracks_of_one_name(read: Read) -> None:
    run = Run()
    threads = [run.thread(f"worker {number}") for number in range(2)]
    group = run.reentrant(run.node("/n"))
    for number, thread in enumerate(threads):
        run.callback(run.timer(group, f"t{number}", 1.0), thread, 1.0 + number, 2.0)
    trace = read(run.events)
    tracks = trace.named("A reentrant /n")
    assert [[s.name for s in trace.slices[track]] for track in tracks] == [["t0"], ["t1"]]


@both
def test_what_runs_when_events_are_lost_ends_where_its_thread_begins_anew(read: Read) -> None:
    run = Run()
    main = run.thread("MainThread")
    timer = run.timer(run.exclusive(run.node("/n")), "tick", 1.0)
    run.callback(timer, main, 1.0)
    run.lost(3, 1.5)
    run.callback(timer, main, 2.0, 0.5)
    trace = read(run.events)
    [track] = trace.named("MainThread")
    assert [(s.start, s.end) for s in trace.slices[track]] == [(ns(1), ns(2)), (ns(2), ns(2.5))]
    assert_sound(trace)


@both
def test_a_file_without_its_beginning_still_has_tracks_for_all(read: Read) -> None:
    beginnings = (NodeAppeared, ThreadAppeared, GroupAppeared, EntityAppeared, RunStarted)
    trace = read([event for event in small_run() if not isinstance(event, beginnings)])
    assert_sound(trace)
    assert trace.named("thread 1")


@both
def test_an_event_of_any_kind_can_be_exported(read: Read) -> None:
    assert_sound(read(FULL))
    for kind in kinds():
        assert_sound(read([*CAST, full(kind)]))


@both
def test_a_message_that_arrives_or_is_sent_twice_has_one_arrow_at_a_time(read: Read) -> None:
    run = Run()
    odom = run.subscription(run.exclusive(run.node("/n")), "/odom", "odom_callback")
    message = run.message(odom, 1.0)
    run.add(EntityReady(ns(1.1), odom, 2, message))
    run.add(Published(ns(1.2), message, "/odom", 0, 0))
    run.over(3.0)
    assert_sound(read(run.events))


@both
def test_what_leaves_a_queue_unseen_ends_its_arrow(read: Read) -> None:
    run = Run()
    odom = run.subscription(run.exclusive(run.node("/n")), "/odom", "odom_callback")
    for number in range(3):
        run.add(Published(ns(number), number + 1, "/odom", 0, 0))
        run.add(EntityReady(ns(number), odom, 1, number + 1))
    run.gone(odom, 2.5)
    run.over(9.0)
    trace = read(run.events)
    [track] = trace.named("odom_callback (/odom)")
    assert trace.instants[track] == [
        (ns(1), "left the queue"),
        (ns(2), "left the queue"),
        (ns(2.5), "destroyed"),
    ]
    assert_sound(trace)


@both
def test_a_wait_does_not_begin_before_the_one_before_has_ended(read: Read) -> None:
    run = Run()
    main = run.thread("MainThread")
    odom = run.subscription(run.exclusive(run.node("/n")), "/odom", "odom_callback")
    run.message(odom, 1.0)
    run.message(odom, 1.2)
    run.wait(odom, 1.0, 1.5)
    run.callback(odom, main, 1.5, 0.2)
    run.wait_changes(odom, at=1.7, since=1.2, reason=Reason.NO_FREE_WORKER)
    trace = read(run.events)
    [track] = trace.named("odom_callback (/odom)")
    assert [(s.start, s.end) for s in trace.slices[track]] == [(ns(1), ns(1.5)), (ns(1.5), ns(1.7))]
    assert_sound(trace)
