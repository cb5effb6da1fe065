"""Rules of the timeline that random runs do not show."""

from math import inf

from sim.trace import events as ev
from sim.trace.events import GroupKind, kinds
from sim.trace.model import AxisMark, AxisMarkKind, Moment, Queue, QueuedMessage, Window
from sim.trace.timeline import Timeline
from tests.support.runs import Run, ns, shared_group_run
from tests.trace.samples import CAST, FULL, full

ALWAYS = Window(-1, ns(1000.0))


def timeline_of(run: Run) -> Timeline:
    timeline = Timeline()
    timeline.extend(run.events)
    return timeline


def small_run() -> tuple[Run, int, int]:
    """A run with one thread and one subscription, with their ids."""
    run = Run()
    thread = run.thread("MainThread")
    entity = run.subscription(run.exclusive(run.node("/node")), "/odom", "odom_callback", depth=2)
    return run, thread, entity


def test_an_empty_timeline_knows_nothing_and_says_so() -> None:
    empty = Timeline()
    assert (empty.end, empty.lost, empty.started, empty.ended) == (0, 0, None, None)
    assert empty.moment(5) == Moment(5)
    assert empty.queue(1, 5) == Queue(0, 0)
    assert empty.busy(1, Window(0, 10)) == 0.0
    assert (empty.dropped(5), empty.drops_of(1, ALWAYS), empty.calls_of(1, ALWAYS)) == (0, 0, 0)
    assert (empty.robot(5), empty.command(5), empty.scan(5), empty.scan_seen(5)) == (None,) * 4
    assert (empty.publication(1), empty.neighbour(5, 1), empty.neighbour(5, -1)) == (None,) * 3
    assert not empty.group_members(1)
    assert not any((empty.threads, empty.executors, empty.nodes, empty.groups, empty.entities))
    assert not any(
        (empty.calls, empty.logs, empty.shell, empty.completed, empty.notices, empty.logs_until(5))
    )
    assert not any((empty.spans_on(1, ALWAYS), empty.spans_of(1, ALWAYS), empty.spans_in(1, ALWAYS)))
    assert not any((empty.waits_of(1, ALWAYS), empty.marks(ALWAYS), empty.trail(ALWAYS)))


def test_asking_of_what_is_not_known_adds_nothing_to_the_cast() -> None:
    timeline = Timeline()
    timeline.spans_on(1, ALWAYS)
    timeline.queue(1, 5)
    assert timeline.moment(5) == Moment(5)


def test_a_failure_of_what_has_no_callback_is_told_by_its_name() -> None:
    run = Run()
    thread = run.thread("MainThread")
    client = run.client(run.exclusive(run.node("/node")), "/turn")
    run.start(client, thread, 1.0)
    run.fail(client, thread, 2.0, "ValueError: no")
    (mark,) = (each for each in timeline_of(run).marks(ALWAYS) if each.kind == "error")
    assert mark.text.startswith("reply of /turn raised ValueError")


def test_every_kind_of_event_is_understood() -> None:
    Timeline().extend([*CAST, *map(full, kinds())])
    timeline = Timeline()
    timeline.extend(FULL)
    assert timeline.end == 3_000_000_000
    assert timeline.started == FULL[0]
    assert timeline.ended == FULL[-1]
    assert timeline.lost == 12
    assert [line.text for line in timeline.logs] == ["Odom CallBack", "hello"]
    assert [type(each) for each in timeline.shell] == [
        *(ev.Printed, ev.KeyboardAsked, ev.Typed),
        *(ev.LineGiven, ev.LineSaid, ev.LineEnded),
    ]
    assert timeline.completed == ev.LineCompleted(ns(2.5), 2, 5, ("list", "pub"))
    assert [notice.text for notice in timeline.notices] == ["The robot touches the wall."]
    robot = timeline.robot(ns(2.35))
    assert robot is not None
    assert robot.front == inf
    assert timeline.robot(ns(2.35) - 1) is None
    assert timeline.command(ns(2.4)) == ev.VelocityCommanded(ns(2.4), 0.08, -0.2)
    assert [each.t for each in timeline.commands(Window(ns(2.4), timeline.end))][:1] == [ns(2.4)]
    assert list(timeline.commands(Window(0, ns(2.4)))) == []
    published = timeline.publication(7)
    assert published is not None
    assert published.at == ns(1.5)


def test_marks_are_the_points_worth_a_sign() -> None:
    timeline = Timeline()
    timeline.extend(FULL)
    assert timeline.marks(ALWAYS) == [
        AxisMark(ns(2.1), AxisMarkKind.CALL, "/motor_power SetBool_Request(data=True)"),
        AxisMark(ns(2.2), AxisMarkKind.REPLY, "/motor_power SetBool_Response(success=True, message='')"),
        AxisMark(ns(2.25), AxisMarkKind.ERROR, "odom_callback raised IndexError: no beam 720"),
        AxisMark(ns(2.5), AxisMarkKind.COMMAND, "/motor_power SetBool data=True"),
        AxisMark(ns(2.5), AxisMarkKind.COMMAND, "ros2 topic list"),
        AxisMark(ns(2.6), AxisMarkKind.NOTICE, "The robot touches the wall."),
    ]
    assert [mark.kind for mark in timeline.marks(Window(ns(2.2), ns(2.5)))] == ["reply", "error"]


def test_groups_get_letters_in_order_of_appearance_and_numbers_after_z() -> None:
    timeline = Timeline()
    timeline.extend(ev.GroupAppeared(0, group, 1, GroupKind.CUSTOM, "G") for group in range(100, 154))
    letters = [group.letter for group in timeline.groups.values()]
    assert letters[:2] == ["A", "B"]
    assert letters[25:28] == ["Z", "A2", "B2"]
    assert letters[51:] == ["Z2", "A3", "B3"]


def test_a_wait_is_shown_from_when_its_callback_was_ready() -> None:
    run, _, entity = small_run()
    run.wait_changes(entity, 2.0, 1.5, ev.Reason.GROUP_HELD, holder=7)
    run.wait_changes(entity, 3.0, 1.5, ev.Reason.NO_FREE_WORKER)
    waits = timeline_of(run).waits_of(entity, ALWAYS)
    assert [(wait.start, wait.end, wait.since) for wait in waits] == [
        (ns(1.5), ns(3.0), ns(1.5)),
        (ns(3.0), None, ns(1.5)),
    ]
    assert [wait.holder for wait in waits] == [7, 0]


def test_a_wait_that_is_taken_up_again_does_not_cover_what_was_shown_before() -> None:
    run, _, entity = small_run()
    run.wait(entity, 1.0, until=2.0)
    run.wait_changes(entity, 3.0, 1.0, ev.Reason.NOBODY_SPINS)
    waits = timeline_of(run).waits_of(entity, ALWAYS)
    assert [(wait.start, wait.end) for wait in waits] == [(ns(1.0), ns(2.0)), (ns(3.0), None)]


def test_a_wait_that_replaces_another_begins_where_that_ends() -> None:
    run, _, entity = small_run()
    run.wait_changes(entity, 2.0, 2.0, ev.Reason.GROUP_HELD)
    run.wait_changes(entity, 5.0, 3.0, ev.Reason.NO_FREE_WORKER)
    waits = timeline_of(run).waits_of(entity, ALWAYS)
    assert [(wait.start, wait.end) for wait in waits] == [(ns(2.0), ns(5.0)), (ns(5.0), None)]


def test_a_wait_whose_end_was_stamped_before_its_start_is_an_instant() -> None:
    timeline = Timeline()
    start = ev.WaitStarted(10, 1, 10, ev.Reason.NO_FREE_WORKER, 0, True)
    timeline.extend([start, ev.WaitEnded(9, 1)])
    assert [(wait.start, wait.end) for wait in timeline.waits_of(1, ALWAYS)] == [(10, 10)]


def test_only_the_first_reply_to_a_call_counts() -> None:
    run, _, _ = small_run()
    call = run.call("/s", 1.0, replied=2.0, response="first")
    run.add(ev.ServiceReplied(ns(3.0), call, "/s", "second"))
    timeline = timeline_of(run)
    assert [(each.replied, each.response) for each in timeline.calls] == [(ns(2.0), "first")]


def test_a_coroutine_leaves_its_thread_and_keeps_its_group() -> None:
    run, thread, entity = small_run()
    other = run.thread("other")
    message = run.message(entity, 1.0)
    run.start(entity, thread, 1.0)
    run.suspend(entity, thread, 2.0)
    run.resume(entity, other, 3.0)
    run.end(entity, other, 4.0)
    timeline = timeline_of(run)
    suspended = timeline.moment(ns(2.5))
    assert not suspended.running
    assert suspended.holders == {1: (entity,)}
    assert [(span.thread, span.message) for span in timeline.spans_of(entity, ALWAYS)] == [
        (thread, message),
        (other, message),
    ]
    assert timeline.calls_of(entity, ALWAYS) == 1
    assert timeline.moment(ns(4.0)).holders == {1: ()}


def test_a_suspended_call_that_ends_lets_its_group_go() -> None:
    run, thread, entity = small_run()
    run.start(entity, thread, 1.0)
    run.suspend(entity, thread, 2.0)
    run.end(entity, thread, 3.0)
    timeline = timeline_of(run)
    assert timeline.moment(ns(2.0)).holders == {1: (entity,)}
    assert timeline.moment(ns(3.0)).holders == {1: ()}


def test_of_nested_calls_the_innermost_runs_and_the_thread_is_busy_once() -> None:
    run, thread, entity = small_run()
    inner = run.timer(run.reentrant(1), "timer_callback", 0.5)
    run.callback(entity, thread, 1.0, 4.0)
    run.callback(inner, thread, 2.0, 1.0)
    run.robot(5.0)
    timeline = timeline_of(run)
    assert [timeline.moment(ns(t)).running[thread].entity for t in (1.5, 2.5, 3.5)] == [entity, inner, entity]
    assert timeline.busy(thread, Window(0, ns(8.0))) == 0.5


def test_a_call_that_runs_on_counts_as_busy_up_to_the_end_of_what_is_known() -> None:
    run, thread, entity = small_run()
    run.callback(entity, thread, 1.0)
    run.robot(3.0)
    timeline = timeline_of(run)
    assert timeline.busy(thread, Window(0, ns(4.0))) == 0.5
    assert timeline.busy(thread, Window(ns(1.0), ns(3.0))) == 1.0


def test_one_long_span_among_thousands_of_short_ones_is_found_from_everywhere() -> None:
    timeline = Timeline()
    timeline.extend(
        [ev.EntityAppeared(0, 1, 1, 1, ev.EntityKind.TIMER, "", "timer", "", 0, 0, 0, 0)]
        + [ev.CallbackStarted(1, 1, 1, 0, 0, 0)]
        + [
            event
            for t in range(10, 50_000, 10)
            for event in (ev.CallbackStarted(t, 1, 2, 0, 0, 0), ev.CallbackEnded(t + 5, 1, 2))
        ]
    )
    for answer in (
        timeline.spans_of(1, Window(30_000, 30_010)),
        timeline.spans_in(1, Window(30_000, 30_010)),
    ):
        assert [(span.start, span.end) for span in answer] == [(1, None), (30_000, 30_005)]


def test_after_lost_events_a_call_whose_end_may_be_lost_ends_when_its_thread_goes_on() -> None:
    run, thread, entity = small_run()
    run.callback(entity, thread, 1.0)
    run.lost(3, 2.0)
    run.callback(entity, thread, 4.0, 1.0)
    timeline = timeline_of(run)
    assert timeline.lost == 3
    assert [(span.start, span.end) for span in timeline.spans_on(thread, ALWAYS)] == [
        (ns(1.0), ns(4.0)),
        (ns(4.0), ns(5.0)),
    ]


def test_what_cannot_be_matched_after_a_loss_is_passed_over() -> None:
    timeline = Timeline()
    timeline.extend(
        [
            ev.CallbackEnded(1, 1, 1),
            ev.CallbackSuspended(2, 1, 1),
            ev.CallbackFailed(3, 1, 1, "Oops", "", 0),
            ev.WaitEnded(4, 1),
            ev.ServiceReplied(5, 9, "/s", "r"),
        ]
    )
    assert not timeline.spans_of(1, ALWAYS)
    assert timeline.calls == []
    assert [mark.text for mark in timeline.marks(ALWAYS)] == ["a callback raised Oops", "/s r"]


def test_an_entity_that_becomes_known_late_brings_its_spans_into_its_group() -> None:
    run, thread, entity = small_run()
    run.callback(entity, thread, 0.0, 1.0)
    events = run.events
    appeared = next(event for event in events if isinstance(event, ev.EntityAppeared))
    events.remove(appeared)
    timeline = Timeline()
    timeline.extend([*events, appeared])
    assert [span.entity for span in timeline.spans_in(1, ALWAYS)] == [entity]


def test_an_entity_that_is_gone_neither_waits_nor_has_a_queue() -> None:
    run, _, entity = small_run()
    run.message(entity, 1.0)
    run.wait(entity, 1.0)
    run.gone(entity, 2.0)
    timeline = timeline_of(run)
    assert timeline.moment(ns(1.5)).queues[entity].depth == 1
    assert timeline.moment(ns(2.0)).queues[entity] == Queue(0, 0)
    assert not timeline.moment(ns(2.0)).waiting
    assert entity in timeline.entities


def test_a_queue_of_which_arrivals_were_lost_still_tells_its_depth() -> None:
    timeline = Timeline()
    timeline.extend([ev.EntityReady(5, 1, 4, 9)])
    assert timeline.queue(1, 5) == Queue(4, 0, [QueuedMessage(9, 5, 5)])


def test_drops_that_are_recorded_late_count_from_their_own_time() -> None:
    timeline = Timeline()
    timeline.extend(
        [ev.MessageDropped(t, entity, 2, 1) for t, entity in ((20, 1), (40, 1), (30, 1), (10, 2))]
    )
    assert [timeline.dropped(t) for t in (9, 10, 20, 30, 40)] == [0, 1, 2, 3, 4]
    assert [timeline.queue(1, t).dropped for t in (19, 20, 30, 40)] == [0, 1, 2, 3]
    assert timeline.drops_of(1, Window(25, 35)) == 1


def test_messages_may_be_recorded_in_another_order_than_they_were_numbered() -> None:
    timeline = Timeline()
    timeline.extend([ev.Published(t, message, "/odom", 0, 0) for t, message in ((10, 5), (9, 3), (11, 4))])
    assert [each and each.at for each in map(timeline.publication, range(2, 7))] == [None, 9, 11, 10, None]


def test_a_scan_recorded_after_a_callback_took_its_message_counts_as_seen() -> None:
    run, thread, entity = small_run()
    message = run.message(entity, 1.0)
    run.callback(entity, thread, 1.0, 0.5)
    run.scan(message, 1.0, b"\x01\x00")
    timeline = timeline_of(run)
    seen = timeline.scan_seen(ns(1.0))
    assert seen is not None
    assert seen.message == message


def test_the_shared_group_at_a_quarter_past_fourteen() -> None:
    run = shared_group_run()
    timeline = timeline_of(run)
    at = ns(14.25)
    odom, scan, timer = timeline.entities
    moment = timeline.moment(at)
    assert [span.entity for span in moment.running.values()] == [timer]
    assert moment.holders == {1: (timer,)}
    assert {entity: wait.holder for entity, wait in moment.waiting.items()} == {odom: timer, scan: timer}
    queue = moment.queues[odom]
    assert (queue.depth, queue.dropped, queue.oldest) == (10, 195, ns(13.752))
    assert [message.age(at) for message in queue.messages] == [
        ns(0.498 - 0.05 * place) for place in range(10)
    ]
    assert timeline.dropped(at) == 390
    assert timeline.busy(1, Window(ns(4.0), at)) == 1.0
    assert timeline.logs[timeline.logs_until(at) - 1].text == "SLEEPING==0 seconds"
    seen, true = timeline.scan_seen(at), timeline.scan(at)
    assert seen is not None
    assert true is not None
    assert (seen.t, true.t) == (ns(3.955), ns(14.205))


def test_a_suspended_call_is_at_its_await_until_it_goes_on_or_ends() -> None:
    frames = (("node.py", "tick", 7),)
    events: list[ev.AnyEvent] = []
    for start in (10, 20):
        events += [ev.CallbackStarted(start, 1, 1, 0, 0, 0), ev.CallbackSuspended(start + 1, 1, 1, frames)]
    timeline = Timeline()
    timeline.extend([*events[:2], ev.CallbackResumed(15, 1, 1), ev.CallbackEnded(16, 1, 1)])
    timeline.extend([*events[2:], ev.CallbackEnded(25, 1, 1)])
    found = timeline.positions_of(1, ALWAYS)
    assert [(each.start, each.end, each.call, each.line, each.thread) for each in found] == [
        (11, 15, "await", 7, 0),
        (21, 25, "await", 7, 0),
    ]
