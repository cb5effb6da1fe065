"""The narrator: what the executor did, and why, at any moment of any run."""

import re

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from textual.geometry import Size

from cbtui.looks.theme import GLYPHS, Charset
from cbtui.runs.live.playhead import Playhead
from cbtui.text.cells import visible
from cbtui.widgets.diagnosis import diagnosis_at
from cbtui.widgets.narrator.narration import decisions_at, narration
from cbtui.widgets.narrator.narrator import ROWS, Narrator
from sim.trace.events import (
    AnyEvent,
    CallbackAt,
    CallbackEnded,
    CallbackFailed,
    CallbackResumed,
    CallbackStarted,
    CallbackSuspended,
    CallBlocked,
    CallUnblocked,
    Doing,
    EntityId,
    GroupKind,
    ProcessAppeared,
    ProcessEnded,
    Reason,
    ThreadAppeared,
)
from sim.trace.figures.concurrency import Concurrency
from sim.trace.timeline import Timeline
from tests.support.runs import Run, ns
from tests.trace.systems import legal_runs
from tests.widgets.pictures import dummy_server, shared_group, split_groups, told

RUNS = (shared_group, split_groups, dummy_server)


def test_a_start_tells_the_thread_the_reason_the_order_and_the_group() -> None:
    run = Run()
    thread = run.thread("MainThread")
    node = run.node("/n")
    group, other = run.exclusive(node), run.exclusive(node)
    tick, heard = run.timer(group, "tick", 1.0), run.subscription(other, "/a", "heard")
    run.message(heard, 1.0)
    run.callback(tick, thread, 1.0, 1.0)
    run.wait(heard, 1.0, 2.0, Reason.NO_FREE_WORKER, tick)
    first, second = narration(told(run, until=1.5), ns(1.0))
    assert first.startswith("1.000 s: MainThread is free: tick is due, timers come first, group A lets it in")
    assert second.startswith("heard is ready")
    assert "group B would let it in, but no thread is free" in second
    ended = narration(told(run, until=2.5), ns(2.0))
    assert "tick returns after 1.0 s, group A is free" in ended[0]


def test_a_callback_whose_process_is_killed_is_not_said_to_return() -> None:
    run = Run()
    run.add(ProcessAppeared(0, 1, "node.py-7"))
    run.add(ThreadAppeared(0, 1, "MainThread", process=1))
    tick = run.timer(run.exclusive(run.node("/n")), "tick", 1.0)
    run.callback(tick, 1, 1.0, 1.0)
    run.add(ProcessEnded(ns(2.0), 1, "node.py-7 was killed", 1))
    ended = narration(told(run, until=2.5), ns(2.0))
    assert ended[0] == "2.000 s: tick does not return: its process ends, 1.0 s after it began"


def test_a_callback_that_takes_no_time_is_told_to_have_returned_where_its_thread_is_idle() -> None:
    run = Run()
    tick = run.timer(run.exclusive(run.node("/n")), "tick", 1.0)
    run.callback(tick, run.thread("MainThread"), 1.0, 0.0)
    assert narration(told(run, until=1.5), ns(1.0))[0].endswith("→ runs, and returns at once")


@pytest.mark.parametrize(
    ("lasted", "said"),
    [(0.5, "1.500 s: tick raises after 500 ms: E"), (0.0, "→ runs, and raises at once: E")],
)
def test_a_callback_that_raises_is_not_said_to_return(lasted: float, said: str) -> None:
    run = Run()
    thread, tick = run.thread("MainThread"), run.timer(run.exclusive(run.node("/n")), "tick", 1.0)
    run.start(tick, thread, 1.0)
    run.fail(tick, thread, 1.0 + lasted, "E")
    run.end(tick, thread, 1.0 + lasted)
    assert narration(told(run, until=2.5), ns(1.0 + lasted))[0].endswith(said)


def test_a_step_to_a_moment_without_a_decision_is_told_at_its_time() -> None:
    run = Run()
    group = run.exclusive(run.node("/n"))
    tick = run.timer(group, "tick", 1.0)
    run.callback(tick, run.thread("MainThread"), 1.0, 3.0)
    run.call("/empty", 2.0, 2.5)
    run.robot(0.0, linear=-3e-17, angular=1e-17)  # what physics leaves to a robot at rest
    for place, (at, doing) in enumerate([(1.2, Doing.SLEEPS), (1.8, Doing.COMPUTES)]):
        run.add(CallbackAt(ns(at), tick, 1, doing, "", (("node.py", "tick", 12 + place),)))
    run.log("one", 2.7)
    run.log("two", 2.8)
    run.printed("three", 2.8)
    timeline = told(run, until=2.9)
    assert narration(timeline, ns(1.0), stepped=True) == narration(timeline, ns(1.0))
    assert narration(timeline, ns(1.5), stepped=True)[0] == "time goes on to 1.500 s: tick still runs"
    assert narration(timeline, ns(1.8), stepped=True)[0] == "1.800 s: tick has slept, and goes on"
    assert narration(timeline, ns(1.9), stepped=True)[0] == (
        "1.800 s: tick has slept, and goes on; then time goes on to 1.900 s: tick still runs"
    )
    assert narration(timeline, ns(2.5), stepped=True)[0] == "2.500 s: /empty replies"
    assert narration(timeline, ns(2.7), stepped=True)[0] == "2.700 s: a line is written to the log"
    assert narration(timeline, ns(2.8), stepped=True)[0] == "2.800 s: 2 lines are written to the log"
    assert narration(timeline, ns(1.5))[0].startswith("1.000 s: ")


def test_timers_that_are_just_due_are_told_before_the_executor_looks() -> None:
    run = Run()
    run.executor("MultiThreadedExecutor", 4)
    node = run.node("/n")
    once = run.timer(run.exclusive(node), "once", 1.0)
    ask = run.timer(group := run.exclusive(node), "ask", 1.0)
    other = run.timer(group, "other", 1.0)
    again = run.timer(run.reentrant(node), "again", 1.0)
    run.callback(once, run.thread("Thread-1"), 1.0, 0.5)
    run.callback(ask, run.thread("Thread-2"), 1.0, 5.0)
    run.callback(other, run.thread("Thread-3"), 1.0, 0.5)
    run.callback(again, run.thread("Thread-4"), 1.0, 5.0)
    timeline = told(run, until=1.9)
    assert narration(timeline, ns(1.9), stepped=True)[1:] == (
        "nothing else is ready: 2 of 4 threads are idle",
    )
    assert narration(timeline, ns(2.0), stepped=True) == (
        "2.000 s: 4 timers fall due",
        "once is due: it is free to run; ask is due again: its last call still runs; "
        "other is due: group B held by ask; again is due: it is free to run",
    )


def test_a_reply_whose_group_its_caller_keeps_is_not_said_to_be_free_to_run() -> None:
    run = Run()
    run.executor("MultiThreadedExecutor", 4)
    group = run.exclusive(run.node("/n"))
    pick, thread = run.timer(group, "pick", 5.0), run.thread("Thread-1")
    reply = run.client(group, "/gripper")
    run.start(pick, thread, 1.0)
    run.blocked(run.call("/gripper", 1.0, 1.3, entity=pick), "/gripper", thread, pick, 1.0)
    run.message(reply, 1.3)
    assert narration(told(run), ns(1.3), stepped=True) == (
        "1.300 s: /gripper replies",
        "reply of /gripper is there: group A held by pick",
        "pick has waited in its call of /gripper since 1.000 s",
    )
    assert narration(told(run), ns(1.2), stepped=True)[0] == "time goes on to 1.200 s", "and not that it runs"


def test_a_caller_whose_reply_has_just_been_taken_is_about_to_go_on() -> None:
    run = Run()
    run.executor("MultiThreadedExecutor", 2)
    node, first, second = run.node("/n"), run.thread("Thread-1"), run.thread("Thread-2")
    left, reply = run.timer(run.exclusive(node), "left", 5.0), run.client(run.exclusive(node), "/clamp")
    run.start(left, first, 1.0)
    call = run.call("/clamp", 1.0, 1.3, entity=left)
    run.blocked(call, "/clamp", first, left, 1.0)
    run.add(CallbackStarted(ns(1.3), reply, second, call, 0, 0))
    run.end(reply, second, 1.3)
    timeline = told(run)
    assert narration(timeline, ns(1.3))[-1] == "left has its reply from /clamp, and is about to go on"
    assert narration(timeline, ns(1.4), stepped=True)[-1] == (
        "left has had its reply from /clamp since 1.300 s, but the executor has yet to hand it over"
    )


def test_the_age_of_a_message_is_told_only_where_it_has_one() -> None:
    run = Run()
    heard = run.subscription(run.exclusive(run.node("/n")), "/a", "heard")
    run.callback(heard, run.thread("MainThread"), 1.0, 1.0)
    assert "heard has a message, group A" in narration(told(run, until=1.5), ns(1.0))[0]


@pytest.mark.parametrize(("threads", "when"), [(2, "it is free to run"), (1, "no thread is free")])
def test_a_step_to_an_arrival_tells_it_before_the_executor_looks(threads: int, when: str) -> None:
    run = Run()
    node = run.node("/n")
    run.executor("MultiThreadedExecutor", threads)
    tick = run.timer(run.exclusive(node), "tick", 1.0)
    hold = run.service(run.exclusive(node), "/clamp", "hold")
    reply = run.client(run.exclusive(node), "/clamp")
    run.start(tick, run.thread("Thread-1"), 1.0)
    run.message(hold, 1.0)
    run.message(reply, 1.0)
    timeline = told(run)
    assert narration(timeline, ns(1.0), stepped=True)[1] == (
        f"hold has 1 queued: {when}; reply of /clamp is there: {when}"
    )
    said = diagnosis_at(timeline, ns(1.0), Concurrency(timeline)).text
    assert said.startswith("hold is ready; ")


def test_a_first_step_to_a_moment_without_an_action_is_told_as_any_other() -> None:
    run = Run()
    run.timer(run.exclusive(run.node("/n")), "tick", 5.0)
    run.log("one", 1.0)
    timeline = told(run)
    assert narration(timeline, ns(1.0), stepped=True)[0] == "1.000 s: a line is written to the log"
    assert narration(timeline, ns(1.0)) == ("nothing has happened yet",)


@pytest.mark.parametrize(("linear", "angular", "does"), [(0.1, 0.2, "drives"), (0.0, 0.2, "turns")])
def test_a_step_in_which_the_robot_moves_on_says_how(linear: float, angular: float, does: str) -> None:
    run = Run()
    run.callback(run.timer(run.exclusive(run.node("/n")), "tick", 1.0), run.thread("MainThread"), 1.0, 3.0)
    run.robot(1.0, linear=linear, angular=angular)
    first, *_ = narration(told(run, until=1.5), ns(1.4), stepped=True)
    assert first == f"time goes on to 1.400 s: tick still runs, the robot still {does}"


def test_decisions_of_a_moment_are_told_in_the_order_of_the_trace() -> None:
    run = Run()
    node = run.node("/n")
    left = run.timer(run.exclusive(node), "left", 1.0)
    hold = run.service(run.exclusive(node), "/clamp", "hold")
    first, second = run.thread("MainThread"), run.thread("Thread-1")
    run.callback(left, first, 1.0, 2.0)
    run.blocked(run.call("/clamp", 1.0, 3.0, entity=left), "/clamp", first, left, 1.0, 3.0)
    run.callback(hold, second, 1.0, 2.0)
    begun = narration(told(run), ns(1.0))
    assert [line.split(", ")[0] for line in begun[:3]] == [
        "1.000 s: MainThread is free: left is due",
        "left calls /clamp",
        "Thread-1 is free: hold has a request",
    ]


SAID = {
    CallbackStarted: "→ runs",
    CallbackResumed: "goes on after its await",
    CallbackSuspended: "awaits",
    CallbackEnded: "returns",
    CallBlocked: "calls /service",
    CallUnblocked: "goes on after its call",
}


@given(legal_runs())
@settings(deadline=None)
def test_what_is_told_of_any_moment_follows_the_trace(events: list[AnyEvent]) -> None:
    timeline = Timeline()
    timeline.extend(events)
    callers: dict[int, EntityId] = {
        each.call: each.entity for each in events if isinstance(each, CallBlocked)
    }
    raised = {(each.t, each.thread) for each in events if isinstance(each, CallbackFailed)}
    open_groups = [each.letter for each in timeline.groups.values() if each.kind is GroupKind.REENTRANT]
    for at in {event.t for event in events}:
        lines = narration(timeline, at)
        place = 0
        for event in events:
            if event.t != at or type(event) not in SAID:
                continue
            entity = callers[event.call] if isinstance(event, CallUnblocked) else getattr(event, "entity", 0)
            name = f"callback{entity}" if entity else "the program"
            raises = isinstance(event, CallbackEnded) and (event.t, event.thread) in raised
            says = re.compile(rf"{name}\b.* ?{'raises' if raises else SAID[type(event)]}")
            place = next(number for number in range(place, len(lines)) if says.search(lines[number]))
        assert not any(f"group {letter} is free" in line for letter in open_groups for line in lines)


def test_a_callback_that_its_own_last_call_keeps_waiting_is_told() -> None:
    run = Run()
    group, thread = run.exclusive(run.node("/n")), run.thread("MainThread")
    tick, heard = run.timer(group, "tick", 1.0), run.subscription(group, "/a", "heard")
    run.callback(tick, thread, 1.0, 3.0)
    run.wait(tick, 2.0, 4.0, Reason.GROUP_HELD, tick)
    run.message(heard, 2.5)
    run.wait(heard, 2.5, 4.0, Reason.GROUP_HELD, tick)
    timeline = told(run)
    assert narration(timeline, ns(2.0)) == (
        "2.000 s: tick is due again",
        "tick is due again: its last call still runs",
    )
    assert narration(timeline, ns(2.5)) == (
        "2.500 s: heard is ready",
        "heard is ready, 1 queued: group A held by tick",
    )


def test_what_goes_before_a_timer_that_is_due_again_was_ready_at_the_executors_last_look() -> None:
    run = Run()
    group, thread = run.exclusive(run.node("/n")), run.thread("MainThread")
    tick, heard = run.timer(group, "tick", 1.0), run.subscription(group, "/a", "heard")
    run.callback(tick, thread, 1.0, 3.0)
    run.message(heard, 1.5)
    run.wait(heard, 1.5, 4.0, Reason.GROUP_HELD, tick)
    run.wait(tick, 2.0, 4.0, Reason.GROUP_HELD, tick)
    still = run.subscription(group, "/b", "still")
    run.message(still, 1.5)
    run.wait(still, 1.5, 5.0, Reason.GROUP_HELD, tick)
    run.callback(heard, thread, 4.0, 0.0)
    run.callback(tick, thread, 4.0, 0.5)
    returned, first, second, *_ = narration(told(run), ns(4.0))
    assert returned == "4.000 s: tick returns after 3.0 s, group A is free"
    assert "heard has a message, 2.5 s old, it was ready when the executor last looked, group A" in first
    assert "tick is due, timers come first, group A" in second


def test_a_callback_that_stands_in_its_call_is_told_after_it_has_begun_to() -> None:
    run = Run()
    group, thread = run.exclusive(run.node("/n")), run.thread("MainThread")
    ask, heard = run.timer(group, "ask", 1.0), run.subscription(group, "/a", "heard")
    run.callback(ask, thread, 1.0, 4.0)
    run.blocked(run.call("/ask", 1.5, ask), "/ask", thread, ask, 1.5)
    run.message(heard, 2.5)
    run.wait(heard, 2.5, 4.0, Reason.GROUP_HELD, ask)
    timeline = told(run)
    assert narration(timeline, ns(3.0)) == (
        "2.500 s: heard is ready",
        "heard has waited since 2.500 s, 1 queued: group A held by ask",
        "ask has waited in its call of /ask since 1.500 s",
    )
    assert not any("has stood" in told for told in narration(timeline, ns(1.5)))


def test_in_a_reentrant_group_a_callback_waits_for_a_thread_and_not_for_its_own_last_call() -> None:
    run = Run()
    run.executor("MultiThreadedExecutor", 1)
    asked = run.service(run.reentrant(run.node("/n")), "/a", "asked")
    run.callback(asked, run.thread("MainThread"), 1.0, 2.0)
    run.request(asked, 1.5)
    run.wait(asked, 1.5, 3.0, Reason.NO_FREE_WORKER, asked, workers_busy=True)
    timeline = told(run)
    assert narration(timeline, ns(2.0)) == (
        "1.500 s: asked is ready",
        "asked has waited since 1.500 s, 1 queued: group A would let it in, but no thread is free",
    )
    assert narration(timeline, ns(3.0))[0] == "3.000 s: asked returns after 2.0 s, MainThread is free"
    assert diagnosis_at(timeline, ns(2.0), Concurrency(timeline)).text == (
        "asked waits 500 ms: the only thread runs asked"
    )


def test_nobody_waits_for_a_thread_while_one_of_its_executor_is_free() -> None:
    run = Run()
    run.executor("MultiThreadedExecutor", 2)
    think = run.timer(run.reentrant(run.node("/n")), "think", 1.0)
    source = run.timer(run.reentrant(run.node("/n")), "source", 1.0)
    run.callback(think, run.thread("ThreadPoolExecutor-0_0"), 1.0, 2.0)
    run.callback(think, run.thread("ThreadPoolExecutor-0_1"), 1.0, 3.0)
    run.wait(source, 2.0, 5.0, Reason.NO_FREE_WORKER, think, workers_busy=True)
    timeline = told(run, until=3.0)
    assert "no thread is free" in narration(timeline, ns(2.9))[-1]
    assert narration(timeline, ns(3.0)) == (
        "3.000 s: think returns after 2.0 s, Pool-0_0 is free",
        "source is ready for 1.0 s: it is free to run",
    )
    assert "no thread" not in diagnosis_at(timeline, ns(3.0), Concurrency(timeline)).text


def test_waits_are_told_as_of_the_moment_and_decisions_as_of_their_own() -> None:
    run = Run()
    group = run.exclusive(run.node("/n"))
    tick, heard = run.timer(group, "tick", 1.0), run.subscription(group, "/a", "heard")
    run.callback(tick, run.thread("MainThread"), 1.0, 3.0)
    run.wait(heard, 2.0, 4.0, Reason.GROUP_HELD, tick)
    for at in (2.0, 2.4, 2.8):
        run.message(heard, at)
    assert narration(told(run), ns(2.9)) == (
        "2.000 s: heard is ready",
        "heard has waited since 2.000 s, 3 queued: group A held by tick",
    )


def test_a_callback_that_awaits_is_not_said_to_return_or_to_free_its_group() -> None:
    run = Run()
    tick, thread = run.timer(run.exclusive(run.node("/n")), "tick", 1.0), run.thread("MainThread")
    run.start(tick, thread, 1.0)
    run.suspend(tick, thread, 1.5)
    run.resume(tick, thread, 2.0)
    run.end(tick, thread, 2.0)
    timeline = told(run)
    assert (
        narration(timeline, ns(1.5))[0] == "1.500 s: tick awaits, on no thread, and keeps group A meanwhile"
    )
    assert narration(timeline, ns(2.0))[0] == (
        "2.000 s: MainThread is free: tick goes on after its await, and returns at once"
    )


def test_a_callback_inside_another_one_is_not_said_to_have_or_to_leave_a_free_thread() -> None:
    run = Run()
    node, thread = run.node("/n"), run.thread("MainThread")
    ask, tick = run.timer(run.exclusive(node), "ask", 1.0), run.timer(run.reentrant(node), "tick", 1.0)
    run.start(ask, thread, 1.0)
    run.callback(tick, thread, 2.0, 0.5)
    run.callback(tick, thread, 3.0, 0.0)
    run.end(ask, thread, 3.0)
    timeline = told(run)
    assert narration(timeline, ns(2.5))[0] == "2.500 s: tick returns after 500 ms"
    for at in (2.0, 3.0):
        assert "MainThread spins inside ask: tick is due" in narration(timeline, ns(at))[0]


def test_who_waits_for_a_group_is_told_with_its_holder() -> None:
    told_at = narration(shared_group(), ns(6.0))
    assert any(
        "odom_callback has waited since 4.0" in line and "group A held by timer" in line for line in told_at
    )


def test_losses_in_a_row_are_told_together_and_passed_over_in_one_step() -> None:
    run = Run()
    group = run.exclusive(run.node("/n"))
    tick, heard = run.timer(group, "tick", 1.0), run.subscription(group, "/a", "heard", depth=1)
    run.callback(tick, run.thread("MainThread"), 1.0, 2.0)
    run.wait(heard, 1.1, 3.0, Reason.GROUP_HELD, tick)
    for at in (1.1, 1.5, 1.6, 1.7):
        run.message(heard, at)
    run.log("later", 3.4)
    timeline = told(run, until=3.5)
    assert narration(timeline, ns(1.5))[0] == "1.500 s: the full queue of heard loses its oldest message"
    assert narration(timeline, ns(1.7))[0] == "1.700 s: the full queue of heard has lost 3 since 1.500 s"
    run.callback(run.timer(run.exclusive(run.node("/m")), "tock", 1.0), run.thread("Thread-1"), 1.55, 0.01)
    assert narration(told(run, until=3.5), ns(1.7))[0].endswith("has lost 2 since 1.600 s, 3 in all")
    steps = [Playhead(at=ns(1.1))]
    for step in (1, 1, -1, -1):
        steps.append(steps[-1].beside([timeline], timeline.end, step))
    assert [each.at for each in steps] == [ns(at) for at in (1.1, 1.7, 3.0, 1.7, 1.1)]


def test_each_decision_of_a_moment_has_a_line_of_its_own_and_the_one_looked_at_is_marked() -> None:
    run = Run()
    group, thread = run.exclusive(run.node("/n")), run.thread("MainThread")
    run.callback(run.timer(group, "first", 1.0), thread, 1.0, 1.0)
    run.callback(run.timer(group, "second", 1.0), thread, 2.0, 1.0)
    narrator = Narrator()
    narrator.timeline, narrator.now, narrator.place = told(run, until=3.5), ns(2.0), 1
    assert decisions_at(narrator.timeline, ns(2.0)) == 2
    ended, begun, *_ = (row[0].text.rstrip() for row in narrator.rows(Size(100, ROWS)))
    assert ended == "   2.000 s: first returns after 1.0 s, group A is free"
    assert begun.startswith(" ▸ MainThread is free: second is due")
    assert not any("panes" in row[0].text for row in narrator.rows(Size(100, ROWS)))
    narrator.place = 0
    earlier = narrator.rows(Size(100, ROWS))[0][0].text
    assert "group A is free (panes show the end of this moment)" in earlier
    narrator.place = 1
    assert "2.000 s, decision 2: MainThread is free: second" in narrator.rows(Size(100, 1))[0][0].text
    narrator.now, narrator.stepped = ns(2.2), False
    assert "2.000 s, decision 2: " in narrator.rows(Size(100, 1))[0][0].text, "dated by when it was decided"


@pytest.mark.parametrize("more", range(1, 7))
def test_each_step_within_a_moment_shows_the_newest_decision(more: int) -> None:
    run = Run()
    thread, group = run.thread("MainThread"), run.exclusive(run.node("/n"))
    for place in range(more):
        run.callback(run.timer(group, f"tick_{place}", 1.0), thread, 2.0, 0.0)
    narrator = Narrator()
    narrator.timeline, narrator.now = told(run, until=2.0), ns(2.0)
    for narrator.stepped in (True, False):
        (here,) = (row[0].text for row in narrator.rows(Size(80, ROWS)) if "▸" in row[0].text)
        assert f"tick_{more - 1} is due" in here


def test_what_waits_behind_a_call_that_has_returned_is_free_to_run() -> None:
    run = Run()
    heard = run.subscription(run.exclusive(run.node("/n")), "/a", "heard")
    run.message(heard, 0.9)
    run.callback(heard, run.thread("MainThread"), 1.0, 1.0)
    run.message(heard, 1.2)
    run.wait(heard, 1.2, 2.5, Reason.GROUP_HELD, heard)
    returned = narration(told(run, until=2.2), ns(2.0))
    assert returned[-1] == "heard has 1 queued, the next for 800 ms: it is free to run"
    while_it_runs = narration(told(run, until=2.2), ns(1.5))
    assert while_it_runs[-1].endswith("its last call still runs")


def test_a_callback_whose_function_says_nothing_is_named_after_its_topic() -> None:
    run = Run()
    heard = run.subscription(run.exclusive(run.node("/n")), "/picture", "callback")
    run.callback(heard, run.thread("MainThread"), 1.0, 1.0)
    assert "/picture has a message" in narration(told(run, until=1.5), ns(1.0))[0]


def test_a_cause_is_told_once_however_many_wait_for_it() -> None:
    lines = narration(shared_group(), ns(6.0))
    assert "".join(lines).count("held by timer_callback") == 1
    assert any("odom_callback has" in line and "scan_callback has" in line for line in lines)


@pytest.mark.parametrize(
    ("threads", "busy", "idle"),
    [
        (1, 0, ": the only thread is idle"),
        (1, 1, ""),
        (2, 0, ": both threads are idle"),
        (4, 0, ": all 4 threads are idle"),
        (4, 1, ": 3 of 4 threads are idle"),
        (2, 1, ": 1 of 2 threads is idle"),
    ],
)
def test_who_is_idle_is_told_where_nothing_waits(threads: int, busy: int, idle: str) -> None:
    run = Run()
    run.executor("MultiThreadedExecutor", threads)
    group = run.exclusive(run.node("/n"))
    tick = run.timer(group, "tick", 5.0)
    run.callback(tick, run.thread("ThreadPoolExecutor-0_0"), 1.0, 1.0)
    moment, what = (1.0, "nothing else") if busy else (2.0, "nothing")
    assert narration(told(run, until=moment + 0.1), ns(moment))[1:] == (f"{what} is ready{idle}",)


@example(Charset.ASCII, ns(14.0), 40)  # two decisions of one moment
@given(st.sampled_from(Charset), st.integers(0, ns(14.0)), st.integers(40, 120))
@settings(deadline=None, max_examples=60)
def test_what_has_no_room_is_told_of_by_an_ellipsis(charset: Charset, at: int, width: int) -> None:
    narrator = Narrator()
    narrator.timeline, narrator.now, narrator.charset = shared_group(), at, charset
    whole, shown = (
        [row[0].text[3:].rstrip() for row in narrator.rows(Size(width, height))] for height in (99, ROWS)
    )
    words = visible(" ".join(narration(shared_group(), at)), charset).split()
    assert " ".join(whole).split() == words, "nothing is cut but by the height"
    is_whole = " ".join(shown).split() == " ".join(whole).split()
    assert is_whole or shown[-1].endswith(GLYPHS[charset].ellipsis)


def test_on_a_wide_screen_sentences_use_its_width_before_any_is_cut() -> None:
    run = Run()
    group = run.exclusive(run.node("/n"))
    thread = run.thread("MainThread")
    for number in range(3):
        run.callback(run.timer(group, f"tick_number_{number}", 1.0), thread, 1.0, 0.0)
    narrator = Narrator()
    narrator.timeline, narrator.now, narrator.place = told(run, until=1.5), ns(1.0), 0
    narrow, wide = (narrator.rows(Size(width, ROWS)) for width in (100, 200))
    assert narrow[-1][0].text.rstrip().endswith("…")
    assert not any("…" in row[0].text for row in wide)


def test_nothing_has_happened_in_an_empty_run() -> None:
    assert narration(Timeline(), 0) == ("nothing has happened yet",)


@given(st.sampled_from(RUNS).map(lambda timeline: timeline()), st.integers(0, ns(15.0)))
@settings(deadline=None, max_examples=60)
def test_any_moment_can_be_told(timeline: Timeline, at: int) -> None:
    lines = narration(timeline, at)
    assert lines
    assert all(line.strip() == line and "another callback" not in line for line in lines)
