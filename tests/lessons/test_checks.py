"""What each check asks of a run: one that passes it, one that fails it, and the moment it points at."""

import pytest

from lessons.checks import (
    ROTATES,
    Check,
    Verdict,
    begin_in_order,
    calls_of,
    data_never_older,
    every_call_answered,
    exclusive_groups_hold,
    is_called,
    is_called_between,
    is_called_often,
    keeps_coming,
    log_never_says,
    log_says,
    never_gets_ahead_of,
    never_loses_messages,
    never_overlap,
    never_raises,
    never_runs_longer_than,
    never_stuck,
    never_takes_older_than,
    never_waits_longer_than,
    no_problem,
    no_problems,
    overlap,
    replies_within,
    rotations,
    runs_long,
    seconds,
    ticks_on_time,
    turns,
    uses_threads,
)
from sim.trace.events import CallbackStarted, EntityReady, Notice, NoticeKind, Reason, RequestLost, Severity
from sim.trace.model import Window
from sim.trace.timeline import Timeline
from tests.support.builder import Run, ns
from tests.support.lesson_runs import (
    dummy_server_one_thread_run,
    dummy_server_run,
    shared_group_run,
    split_groups_run,
)


def timeline(run: Run) -> Timeline:
    found = Timeline()
    found.extend(run.events)
    return found


SHARED = timeline(shared_group_run())
SPLIT = timeline(split_groups_run())
TWO_THREADS = timeline(dummy_server_run())
ONE_THREAD = timeline(dummy_server_one_thread_run())
NOTHING = timeline(Run())
SERVICE = "/dummy_server_srv"


def side_by_side(group: str, *calls: tuple[float, float]) -> Timeline:
    """Calls of `one` and `other` in turn, each from a time and for so long, on a thread of its own."""
    run = Run()
    node = run.node("/node")
    both = run.exclusive(node) if group == "exclusive" else run.reentrant(node)
    run.executor("MultiThreadedExecutor", 4)
    callbacks = [run.timer(both, name, 1.0) for name in ("one", "other")]
    for place, (at, lasts) in enumerate(calls):
        run.callback(callbacks[place % 2], run.thread(f"ThreadPoolExecutor-0_{place}"), at, lasts)
    run.over(10.0)
    return timeline(run)


def driven(*commands: tuple[float, float]) -> Timeline:
    """Commands to turn, each at a time and so fast."""
    run = Run()
    for at, angular in commands:
        run.velocity(at, 0.0, angular)
    run.over(30.0)
    return timeline(run)


TURNED_TWICE = driven((4.0, 0.0), (4.0, -0.2), (9.0, -0.2), (14.0, 0.0), (14.0, -0.2), (24.0, 0.0))
APART = side_by_side("exclusive", (1.0, 1.0), (2.0, 1.0), (3.0, 1.0), (4.0, 1.0))
TOGETHER = side_by_side("exclusive", (1.0, 1.0), (1.5, 1.0))
TWICE = side_by_side("reentrant", (1.0, 3.0), (5.0, 1.0), (2.0, 1.0))


def raising() -> Timeline:
    run = Run()
    timer = run.timer(run.exclusive(run.node("/node")), "tick", 1.0)
    thread = run.thread("MainThread")
    run.callback(timer, thread, 1.0, 0.1)
    run.start(timer, thread, 2.0)
    run.fail(timer, thread, 2.1, "IndexError: list index out of range")
    return timeline(run)


def called(*calls: tuple[float, float | None], lost: bool = False) -> Timeline:
    """Calls of /stop, each sent and replied at a time."""
    run = Run()
    for sent, replied in calls:
        call = run.call("/stop", sent, replied)
        if lost:
            run.add(RequestLost(ns(sent), call, "/stop"))
    run.over(10.0)
    return timeline(run)


def answered(*, taken: bool) -> Timeline:
    """A call of /stop that is answered; the answer is taken by the client, or stays in its queue."""
    run = Run()
    group = run.exclusive(run.node("/node"))
    client = run.client(group, "/stop")
    call = run.call("/stop", 2.0, 3.0)
    run.add(EntityReady(ns(3.0), client, 1, call))
    if taken:
        run.add(CallbackStarted(ns(3.0), client, run.thread("MainThread"), call, 0, 0))
    run.over(10.0)
    return timeline(run)


def answered_and_waited_for(*, until: float | None) -> Timeline:
    """A call of /stop that is answered, while its caller stands still until a time, or for ever."""
    run = Run()
    timer = run.timer(run.exclusive(run.node("/node")), "tick", 1.0)
    worker = run.thread("ThreadPoolExecutor-0_0")
    run.start(timer, worker, 2.0)
    call = run.call("/stop", 2.0, 3.0, entity=timer)
    run.blocked(call, "/stop", worker, timer, 2.0, until)
    run.over(10.0)
    return timeline(run)


def deadlocked() -> Timeline:
    """A timer calls a service of its own exclusive group, and waits for it for ever."""
    run = Run()
    run.executor("MultiThreadedExecutor", 4)
    group = run.exclusive(run.node("/node"))
    timer = run.timer(group, "tick", 1.0)
    service = run.service(group, "/stop", "stop")
    run.client(group, "/stop")
    worker = run.thread("ThreadPoolExecutor-0_0")
    run.start(timer, worker, 1.0)
    call = run.call("/stop", 1.0, entity=timer)
    run.blocked(call, "/stop", worker, timer, 1.0)
    run.request(service, 1.0)
    run.wait(service, 1.0, holder=timer)
    run.over(10.0)
    return timeline(run)


def locked() -> Timeline:
    """Two threads wait for each other's locks."""
    run = Run()
    run.add(Notice(ns(3.0), Severity.ERROR, "a waits for b, b for a", kind=NoticeKind.DEADLOCK))
    run.over(10.0)
    return timeline(run)


def said(*texts: str) -> Timeline:
    run = Run()
    for second, text in enumerate(texts, start=1):
        run.log(text, second)
    run.over(10.0)
    return timeline(run)


def listening(*messages: tuple[float, float], waits: float = 0.0, depth: int = 10) -> Timeline:
    """A timer called at 1 and 2 s, and messages, each published and taken at a time, after a wait."""
    run = Run()
    node = run.node("/node")
    timer = run.timer(run.exclusive(node), "tick", 1.0)
    scan = run.subscription(run.exclusive(node), "/scan", "look", depth)
    thread = run.thread("MainThread")
    for at in (1.0, 2.0):
        run.callback(timer, thread, at, 0.1)
    for published, taken in messages:
        run.message(scan, published)
        if waits:
            run.wait(scan, taken - waits, taken, Reason.NO_FREE_WORKER)
        run.callback(scan, thread, taken, 0.2)
    run.over(10.0)
    return timeline(run)


SEES = listening((1.2, 1.3), (2.2, 2.3))
EARLY = listening((0.1, 0.3), (2.2, 3.3))
FULL = listening((1.2, 3.0), (1.3, 4.0), depth=1)


@pytest.mark.parametrize(
    ("check", "passing", "failing", "seen", "at"),
    [
        (keeps_coming("/scan", ROTATES, 15), SPLIT, SHARED, "0 calls in 20 s", 4.0),
        (
            keeps_coming("scan_callback", runs_long("timer_callback"), 15),
            SPLIT,
            SHARED,
            "0 calls in 10 s",
            4.0,
        ),
        (
            keeps_coming("timer_callback", is_called(SERVICE), 0.9),
            TWO_THREADS,
            ONE_THREAD,
            "0 calls in 5 s",
            2.55,
        ),
        (data_never_older("/scan", "timer_callback", 0.2), SPLIT, SHARED, "10 s old", 14.0),
        (turns(1), SPLIT, TURNED_TWICE, "2 turns", 14.0),
        (turns(2), TURNED_TWICE, SPLIT, "1 turn", 4.0),
        (turns(1), SPLIT, NOTHING, "0 turns", None),
        (overlap(SERVICE, "timer_callback"), TWO_THREADS, ONE_THREAD, "always one after the other", 2.55),
        (overlap("one", "other"), TOGETHER, APART, "always one after the other", 1.0),
        (overlap("one", "one"), TWICE, APART, "always one after the other", 1.0),
        (never_overlap("one"), APART, TWICE, "one twice at once", 2.0),
        (never_overlap("one", "other"), APART, TOGETHER, "one beside other", 1.5),
        (exclusive_groups_hold(), TWICE, TOGETHER, "one beside other", 1.5),
        (ticks_on_time("timer_callback", 0.05), TWO_THREADS, ONE_THREAD, "4.55 s late", 7.55),
        (is_called_often("timer_callback", 8), TWO_THREADS, ONE_THREAD, "6 calls", 10.0),
        (is_called_between("look", 1, 2), SEES, APART, "no call of look", None),
        (is_called_between("one", 0, 1), SEES, APART, "2 calls", 3.0),
        (never_waits_longer_than("look", 0.1), SEES, APART, "no call of look", None),
        (
            never_waits_longer_than("/scan", 0.1),
            SEES,
            listening((0.8, 1.3), (2.7, 3.2), waits=0.5),
            "a wait of 0.5 s, no free worker",
            0.8,
        ),
        (never_runs_longer_than("one", 1.0), APART, TWICE, "a call of 3 s", 1.0),
        (never_takes_older_than("look", 0.2), SEES, EARLY, "a message 1.1 s old", 3.3),
        (never_loses_messages("/scan"), SEES, FULL, "1 message lost", 1.3),
        (begin_in_order("tick", "look"), SEES, EARLY, "look, then tick", 0.3),
        (begin_in_order("tick", "look"), SEES, NOTHING, "no call of tick", None),
        (never_gets_ahead_of("look", "tick"), SEES, EARLY, "call 1 of look after 0 calls of tick", 0.3),
        (never_raises(), SPLIT, raising(), "tick: IndexError: list index out of range", 2.0),
        (uses_threads(2), TWO_THREADS, ONE_THREAD, "at most 1", None),
        (replies_within("/stop", 1.0), called((1.0, 1.5)), called((1.0, 3.0)), "an answer after 2 s", 1.0),
        (replies_within("/stop", 1.0), called((1.0, 1.5)), called((2.0, None)), "no answer in 8 s", 2.0),
        (
            replies_within("/stop", 1.0),
            called((1.0, 1.5)),
            called((2.0, None), lost=True),
            "nobody who took the request",
            2.0,
        ),
        (
            every_call_answered(),
            called((1.0, 1.5), (2.0, 9.0)),
            called((1.0, 1.5), (2.0, None)),
            "1 of 2 without one, the first of /stop",
            2.0,
        ),
        (
            every_call_answered(),
            answered(taken=True),
            answered(taken=False),
            "1 of 1 not taken by the caller, the first of /stop",
            2.0,
        ),
        (
            every_call_answered(),
            answered_and_waited_for(until=3.0),
            answered_and_waited_for(until=None),
            "1 of 1 not taken by the caller, the first of /stop",
            2.0,
        ),
        (log_says("TICK", at_least=2), said("TICK", "TACK", "TICK"), said("TICK", "TACK"), "1", 1.0),
        (log_never_says("Error"), said("fine"), said("fine", "an Error"), "an Error", 2.0),
    ],
    ids=lambda value: value.asks if isinstance(value, Check) else "",
)
def test_a_check_tells_a_run_that_does_it_from_one_that_does_not(
    check: Check, passing: Timeline, failing: Timeline, seen: str, at: float | None
) -> None:
    assert check.judge(passing).passed
    failed = check.judge(failing)
    assert not failed.passed
    assert (failed.seen, failed.at) == (seen, None if at is None else ns(at))


@pytest.mark.parametrize("length", [0.1, 4.1])
def test_what_takes_just_as_long_as_it_may_passes(length: float) -> None:
    heard = listening((1.0, 1.0 + length), waits=length)
    assert never_waits_longer_than("/scan", length).judge(heard).passed
    assert never_takes_older_than("/scan", length).judge(heard).passed
    assert never_runs_longer_than("one", length).judge(side_by_side("exclusive", (1.0, length))).passed
    assert replies_within("/stop", length).judge(called((1.0, 1.0 + length))).passed


def test_where_a_line_is_missing_the_last_logged_error_is_told() -> None:
    run = Run()
    run.log("TICK", 1.0)
    run.log("LookupException: no frame arm", 2.0, severity=Severity.ERROR)
    run.over(10.0)
    failed = log_says("TICK", at_least=2).judge(timeline(run))
    assert (failed.seen, failed.at) == ("1; but the error: LookupException: no frame arm", ns(2.0))
    assert log_says("TICK").judge(timeline(run)).passed


@pytest.mark.parametrize(
    ("check", "good", "bad", "at"),
    [
        (never_stuck(), called((1.0, 2.0)), deadlocked(), 1.0),
        (never_stuck(), called((1.0, 2.0)), locked(), 3.0),
        (no_problem("group-starvation"), SPLIT, SHARED, None),
        (no_problem("no-free-worker"), TWO_THREADS, ONE_THREAD, None),
        (no_problems(), SPLIT, SHARED, None),
    ],
    ids=["never stuck", "locks", "group", "worker", "no problem"],
)
def test_a_check_can_ask_the_diagnosis(check: Check, good: Timeline, bad: Timeline, at: float | None) -> None:
    assert check.judge(good) == Verdict(True, check.judge(good).expected, "none")
    failed = check.judge(bad)
    assert not failed.passed
    assert failed.at is not None
    if at is not None:
        assert failed.at == ns(at)


def test_a_check_can_be_told_in_the_words_of_a_lesson() -> None:
    assert no_problem("group-starvation", asks="nobody waits long").asks == "nobody waits long"
    assert "group" in no_problem("group-starvation").asks


def test_a_rule_that_does_not_exist_is_refused_at_once() -> None:
    with pytest.raises(ValueError, match="no rule is called 'starvation'; there are self-made-deadlock"):
        no_problem("starvation")


ASK_FOR_SOMETHING = (
    keeps_coming("/scan", ROTATES, 15),
    keeps_coming("/scan", runs_long("tick"), 15),
    keeps_coming("/scan", is_called("/stop"), 15),
    data_never_older("/scan", "tick", 0.2),
    turns(1),
    overlap("one", "other"),
    never_overlap("one"),
    ticks_on_time("tick", 0.1),
    is_called_often("tick", 1),
    uses_threads(1),
    replies_within("/stop", 1.0),
    every_call_answered(),
    log_says("TICK"),
)


@pytest.mark.parametrize("check", ASK_FOR_SOMETHING, ids=lambda check: check.asks)
def test_a_run_in_which_nothing_happened_passes_no_check_that_asks_for_something(check: Check) -> None:
    assert not check.judge(NOTHING).passed


def test_what_was_never_there_is_said_by_its_name() -> None:
    verdict = keeps_coming("/scan", ROTATES, 15).judge(NOTHING)
    assert verdict.seen == "no call of /scan"
    still = keeps_coming("/scan", ROTATES, 15).judge(timeline(split_groups_run(3.0)))
    assert still.seen == "no long stretch in which the robot rotates"


def test_a_time_too_short_for_two_calls_is_no_reason_to_fail() -> None:
    run = split_groups_run()
    run.velocity(20.0, 0.0, 0.2)
    run.velocity(20.01, 0.0, 0.0)
    assert keeps_coming("/scan", ROTATES, 15).judge(timeline(run)).passed


def test_a_turn_that_goes_on_at_the_end_counts() -> None:
    run = Run()
    run.velocity(1.0, 0.0, 0.2)
    run.over(3.0)
    assert rotations(timeline(run)) == [Window(ns(1.0), ns(3.0))]


def test_a_callback_is_found_by_its_name_and_by_its_topic() -> None:
    assert calls_of(SPLIT, "/scan") == calls_of(SPLIT, "scan_callback")
    assert len(calls_of(SPLIT, "/scan", Window(ns(4.0), ns(5.0)))) == 20


@pytest.mark.parametrize(
    ("length", "words"), [(9.95, "9.95 s"), (0.044, "44 ms"), (0.0, "0 s"), (10.0, "10 s"), (0.25, "0.25 s")]
)
def test_lengths_are_said_in_short(length: float, words: str) -> None:
    assert seconds(ns(length)) == words


@pytest.mark.parametrize(
    ("length", "limit", "words"),
    [(0.1, 0.1, "0.1 s"), (0.10003, 0.1, "0.10003 s"), (0.05002, 0.05, "50.02 ms"), (0.2, 0.1, "0.2 s")],
)
def test_a_length_beyond_its_limit_is_not_said_in_the_same_words(
    length: float, limit: float, words: str
) -> None:
    assert seconds(ns(length), limit) == words
