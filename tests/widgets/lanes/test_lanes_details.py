"""What a selected bar tells: its cause, its wait and who was in the way, in words."""

from cbtui.looks.theme import Charset
from cbtui.widgets.lanes.details import BarDetails, details_of, details_of_selection
from cbtui.widgets.lanes.details_rows import details_rows
from cbtui.widgets.lanes.rows import ThreadLane
from cbtui.widgets.lanes.selection import Selection
from sim.trace.events import CallbackAt, Doing, Published, Reason, WaitEnded
from sim.trace.model import Span, Window
from sim.trace.timeline import Timeline
from tests.support.runs import Run, ns
from tests.widgets.factory.test_factory_pictures import factory
from tests.widgets.pictures import dummy_server, shared_group, told

ALL = Window(0, ns(1000))


def span_of(timeline: Timeline, callback: str, place: int = 0) -> Span:
    entity = next(each for each in timeline.entities.values() if each.callback == callback)
    return timeline.spans_of(entity.id, ALL)[place]


def text_of(details: BarDetails) -> str:
    return " | ".join((details.title, *details.facts))


def two_callbacks() -> tuple[Run, int, int, int]:
    """One thread and a group with ``a`` on topic /a and the timer ``tick``; return run, thread, a, timer."""
    run = Run()
    thread = run.thread("MainThread")
    group = run.exclusive(run.node("/n"))
    return run, thread, run.subscription(group, "/a", "a_callback"), run.timer(group, "tick_callback", 1.0)


def test_a_late_message_tells_its_age_its_wait_and_who_held_the_group() -> None:
    run, thread, a, tick = two_callbacks()
    run.callback(tick, thread, 1.0, 2.0)
    run.message(a, 1.5, delay=0.25)
    run.wait(a, 1.5, 3.0, Reason.GROUP_HELD, tick)
    run.callback(a, thread, 3.0, 0.004)
    timeline = told(run)
    assert text_of(details_of(timeline, span_of(timeline, "a_callback"), ns(9))) == (
        "A a_callback on MainThread | took 4.0 ms at 3.000 s | "
        "waited 1.5 s: group A held by tick_callback | message 1.8 s old, published by the robot on /a"
    )


def test_a_message_that_a_callback_published_names_it() -> None:
    run, thread, a, tick = two_callbacks()
    run.add(Published(ns(1), 77, "/a", 1, tick))
    timeline = told(run)
    span = Span(ns(2), ns(2.1), a, thread, 77, ns(1))
    assert "message 1.0 s old, published by tick_callback on /a" in details_of(timeline, span, ns(9)).facts


def test_a_message_from_outside_callbacks_names_the_node() -> None:
    run, thread, a, _ = two_callbacks()
    run.add(Published(ns(1), 77, "/a", 1, 0))
    timeline = told(run)
    span = Span(ns(2), ns(2.1), a, thread, 77, ns(1))
    assert "message 1.0 s old, published by /n on /a" in details_of(timeline, span, ns(9)).facts


def test_waits_for_changing_reasons_are_told_as_one_with_the_longest_first() -> None:
    run, thread, a, tick = two_callbacks()
    run.wait(a, 1.0, None, Reason.NO_FREE_WORKER)
    run.wait_changes(a, 1.5, 1.0, Reason.GROUP_HELD, tick)
    run.add(WaitEnded(ns(5.0), a))
    run.callback(a, thread, 5.0, 0.1)
    timeline = told(run)
    assert "waited 4.0 s: group A held by tick_callback, and no free worker" in text_of(
        details_of(timeline, span_of(timeline, "a_callback"), ns(9))
    )


def test_an_earlier_calls_wait_is_not_told_again() -> None:
    run, thread, a, tick = two_callbacks()
    run.wait(a, 1.0, 2.0, Reason.GROUP_HELD, tick)
    run.callback(a, thread, 2.0, 0.1)
    run.callback(a, thread, 3.0, 0.1)
    timeline = told(run)
    assert "waited" in text_of(details_of(timeline, span_of(timeline, "a_callback", 0), ns(9)))
    assert "waited" not in text_of(details_of(timeline, span_of(timeline, "a_callback", 1), ns(9)))


def test_what_still_runs_is_measured_up_to_the_cursor() -> None:
    timeline = shared_group(12.9)
    long = timeline.spans_on(1, Window(ns(5), ns(6)))[0]
    assert "has run since 4.000 s, for 8.9 s" in details_of(timeline, long, ns(12.9)).facts
    assert "has run since 4.000 s, for 2.0 s of 8.9 s" in details_of(timeline, long, ns(6)).facts
    wait = next(iter(timeline.moment(ns(6)).waiting.values()))
    assert "2.0 s of 8.9 s from 4.003 s" in details_of(timeline, wait, ns(6)).facts


def test_a_bar_after_the_moment_on_screen_is_told_to_come_later() -> None:
    timeline = shared_group(12.9)
    long = timeline.spans_on(1, Window(ns(5), ns(6)))[0]
    wait = next(iter(timeline.moment(ns(6)).waiting.values()))
    for bar, begins in ((long, "4.000 s"), (wait, "4.003 s")):
        once_begun = details_of(timeline, bar, bar.end or timeline.end)
        told = details_of(timeline, bar, ns(3))
        assert told.title == once_begun.title
        assert told.facts == (f"begins later, at {begins}", *once_begun.facts)


def test_a_timer_tells_its_period_and_how_late_it_was() -> None:
    run, thread, _, tick = two_callbacks()
    run.callback(tick, thread, 1.3, 0.1, late=0.3)
    timeline = told(run)
    details = details_of(timeline, span_of(timeline, "tick_callback"), ns(9))
    assert "due every 1.0 s, called 300 ms late" in details.facts


def test_a_call_that_raised_tells_the_error() -> None:
    run, thread, a, _ = two_callbacks()
    run.start(a, thread, 1.0)
    run.fail(a, thread, 2.0, "IndexError: 720")
    timeline = told(run)
    details = details_of(timeline, span_of(timeline, "a_callback"), ns(9))
    assert details.facts[:2] == ("took 1.0 s at 1.000 s", "raised IndexError: 720")


def test_a_call_that_stood_still_tells_in_which_service() -> None:
    run, thread, a, _ = two_callbacks()
    call = run.call("/x", 1.5, 3.5, entity=a)
    run.blocked(call, "/x", thread, a, 1.5, 3.5)
    run.callback(a, thread, 1.0, 3.0)
    timeline = told(run)
    assert "stood 2.0 s in call /x" in details_of(timeline, span_of(timeline, "a_callback"), ns(9)).facts


def test_a_call_that_mostly_waited_tells_how_long_and_for_what_in_its_details_and_at_its_seat() -> None:
    run, thread, a, _ = two_callbacks()
    run.start(a, thread, 1.0)
    at = (("/home/ada/node.py", "a_callback", 12),)
    run.add(CallbackAt(ns(1.1), a, thread, Doing.WAITS, "Event.wait", at))
    run.add(CallbackAt(ns(6.0), a, thread, Doing.COMPUTES, "", at))
    run.add(CallbackAt(ns(6.5), a, thread, Doing.WAITS, "Event.wait", at))
    run.end(a, thread, 7.0)
    run.stop(8.0)
    timeline = told(run)
    (span,) = timeline.spans_on(thread, Window(0, ns(8.0)))
    assert "| took 6.0 s at 1.000 s | 5.4 s of it waiting in Event.wait() at node.py:12 |" in text_of(
        details_of(timeline, span, ns(7.2))
    )
    assert "| waits in Event.wait() at node.py:12 |" in text_of(details_of(timeline, span, ns(5.0)))
    assert "a_callback waited 5.4 s" in factory(timeline, 7.01, 140, 20)


def test_that_no_thread_is_free_is_told_once() -> None:
    run, thread, a, tick = two_callbacks()
    run.callback(tick, thread, 1.0, 3.0)
    run.wait(a, 2.0, 4.0, Reason.NO_FREE_WORKER, tick, workers_busy=True)
    timeline = told(run)
    facts = details_of(timeline, timeline.moment(ns(3.0)).waiting[a], ns(3.0)).facts
    assert sum("free" in fact for fact in facts) == 1


def test_a_service_tells_who_called() -> None:
    timeline = dummy_server(8.2)
    text = text_of(details_of(timeline, span_of(timeline, "service_callback"), ns(8.2)))
    assert text.startswith("A service_callback on Pool-0_0 | took 5.0 s at 2.550 s | request ")
    call = timeline.calls[0]
    told_call = text_of(details_of(timeline, call, ns(8.2)))
    assert told_call.startswith(f"call of {call.service} | called from outside at 2.550 s | SetBool_Request")
    assert "replied after 5.0 s: SetBool_Response" in told_call
    assert "no reply for 1.0 s" in text_of(details_of(timeline, call, ns(3.55)))


def test_a_wait_tells_what_the_queue_lost_meanwhile() -> None:
    timeline = shared_group(12.9)
    odom = next(each for each in timeline.entities.values() if each.name == "/odom")
    wait = timeline.waits_of(odom.id, Window(ns(12), ns(12.1)))[0]
    assert text_of(details_of(timeline, wait, ns(12.9))) == (
        "A odom_callback waits | 8.9 s from 4.003 s | group A held by timer_callback | "
        "no thread was free either | queue 10/10, 168 lost in this time"
    )


def test_a_lane_without_a_bar_says_how_to_find_one() -> None:
    timeline = shared_group(1.0)
    lane = ThreadLane(timeline.threads[1])
    assert details_of_selection(timeline, Selection(lane), 0).title == "MainThread"


def test_details_take_two_rows_and_break_between_facts() -> None:
    details = BarDetails("A tick on MainThread", ("took 1.0 s at 2.000 s", "late by 300 ms", "x" * 90))
    rows = ["".join(run.text for run in row) for row in details_rows(details, 60, Charset.BRAILLE)]
    assert rows[0].rstrip() == "▸ A tick on MainThread · took 1.0 s at 2.000 s"
    assert rows[1].startswith("  late by 300 ms · xxx")
    assert rows[1].endswith("…")
    assert [len(row) for row in rows] == [60, 60]


def test_details_reach_the_terminal_as_text_only() -> None:
    details = BarDetails("evil\x1b[2J", ("fact\x07",))
    text = "".join(run.text for row in details_rows(details, 60, Charset.ASCII) for run in row)
    assert text.isprintable()
    assert text.isascii()
