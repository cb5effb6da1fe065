from dataclasses import replace

import pytest

from cbtui.runs.live.findings import ExplainedFinding, FindingsMonitor
from cbtui.runs.live.live_run import LiveRun
from cbtui.runs.live.playhead import Playhead
from cbtui.widgets.diagnosis import (
    Diagnosis,
    DiagnosisLevel,
    call_note,
    diagnosis_at,
    diagnosis_on_screen,
    with_worst_problem,
)
from cbtui.widgets.diagnosis_line import diagnosis_row, diagnosis_rows
from cbtui.widgets.factory.scene import scene_of
from cbtui.widgets.factory.texts import blocked_texts
from cbtui.widgets.narrator.narration import narration
from sim.diagnosis import RULES, CodeLocation, Explanation, Finding
from sim.diagnosis import Weight as RuleWeight
from sim.diagnosis.words import threads_needed
from sim.engine.setup import ProgramSetup, RealRos, RunSetup
from sim.trace.descriptions import executor_label
from sim.trace.events import (
    CallbackAt,
    CallbackStarted,
    Doing,
    Notice,
    NoticeKind,
    OwnThreadAt,
    Reason,
    RunEnded,
    Severity,
)
from sim.trace.figures.concurrency import Concurrency
from sim.trace.timeline import Timeline
from tests.support.builder import Run, ns
from tests.support.engine_runs import run_lesson
from tests.support.fake_session import FakeEngines
from tests.support.runs import (
    dummy_server_one_thread_run,
    dummy_server_run,
    shared_group_run,
    split_groups_run,
)


def timeline_of(run: Run, until: float) -> Timeline:
    timeline = Timeline()
    timeline.extend(run.until(until))
    return timeline


def said(run: Run, at: float) -> Diagnosis:
    timeline = timeline_of(run, at)
    return diagnosis_at(timeline, ns(at), Concurrency(timeline))


def live_run(run: Run, until: float, real: RealRos | None = None) -> LiveRun:
    live = LiveRun(
        RunSetup(title="x", programs=(ProgramSetup("node.py"),), real=real),
        FakeEngines([], 0),
        lambda _: None,
        lambda _: None,
    )
    live.take(run.until(until))
    return live


def verdict_of(live: LiveRun, playhead: Playhead | None = None) -> Diagnosis:
    return diagnosis_on_screen(live, playhead or Playhead(), Concurrency(live.timeline))


def test_who_watches_is_told_how_a_process_comes_and_what_a_key_does_once_all_are_gone() -> None:
    live = live_run(Run(), 0.0, RealRos(watched="/run/probes"))
    assert verdict_of(live).text == "no process to watch yet: start one with cbtui probe -- COMMAND"
    live.take([RunEnded(ns(1.0), "every process that was watched is gone", failed=False)])
    live.over(None)
    assert verdict_of(live).text.endswith(" is gone; press r to watch those that come")


def test_the_longest_wait_is_named_with_its_reason() -> None:
    told = "odom_callback waits 8.9 s: group A is held by timer_callback"
    assert said(shared_group_run(), 12.9) == Diagnosis(
        told, DiagnosisLevel.TROUBLE, at_length=f"{told}; 1 more waits"
    )


def test_a_wait_of_less_than_a_second_is_no_trouble_yet() -> None:
    assert said(shared_group_run(), 4.4).level is DiagnosisLevel.WAITS


def test_where_a_callback_and_its_lane_have_names_unlike_each_other_the_line_tells_both_if_it_can() -> None:
    run = Run()
    group, thread = run.exclusive(run.node("/n")), run.thread("MainThread")
    count = run.subscription(group, "/lock_boxes", "count_with_lock")
    odom = run.subscription(group, "/odom", "odom_callback")
    run.callback(count, thread, 1.0, 2.0)
    run.wait(odom, 1.0, 3.0, Reason.GROUP_HELD, count)
    run.callback(odom, thread, 3.0, 2.0)
    run.wait(count, 3.0, 5.0, Reason.GROUP_HELD, odom)
    run.stop(6.0)
    told = said(run, 2.5)
    assert told.text == "odom_callback waits 1.5 s: group A is held by count_with_lock (lock_boxes)"
    told = said(run, 4.5)
    assert told.text == "count_with_lock (lock_boxes) waits 1.5 s: group A is held by odom_callback"
    narrow = diagnosis_row(told, (), "", 60)[0].text.rstrip()
    assert narrow == " ! count_with_lock waits 1.5 s: group A is held by odom"


def test_a_hand_over_is_neither_a_wait_nor_nothing_that_waits() -> None:
    run = Run(clock="real")
    group, thread = run.exclusive(run.node("/n")), run.thread("MainThread")
    tick, odom = run.timer(group, "tick", 1.0), run.timer(group, "odom_callback", 1.0)
    run.callback(tick, thread, 4.0, 0.008)
    run.wait(odom, 4.003, 4.008, Reason.GROUP_HELD, tick)
    told = said(run, 4.005)
    assert told.text == "odom_callback is ready; one thread does all the work"
    assert told.level is DiagnosisLevel.PENDING
    assert diagnosis_row(told, (), "", 80)[0].text.startswith(" · ")


def test_a_timer_that_is_just_due_again_during_its_call_is_not_told_as_ready() -> None:
    told = said(split_groups_run(), 4.506)
    assert told.text.startswith("timer_callback still runs, due ")


def test_a_callback_that_waits_for_a_lock_is_not_told_as_nothing_waits() -> None:
    run = Run()
    tick = run.timer(run.exclusive(run.node("/n")), "tick", 1.0)
    thread = run.thread("MainThread")
    run.callback(tick, thread, 1.0, None)
    frames = (("node.py", "tick", 7),)
    run.add(CallbackAt(ns(1.0), tick, thread, Doing.WAITS, "Lock.acquire", frames))
    run.stop(4.0)
    told = said(run, 3.5)
    assert (told.text, told.level) == ("tick waits for a lock for 2.5 s", DiagnosisLevel.PENDING)
    begins = said(run, 1.0)
    assert (begins.text, begins.level) == ("tick waits for a lock", DiagnosisLevel.PENDING)


def test_a_reply_that_no_thread_hands_over_is_told_as_there() -> None:
    run = Run()
    run.executor("MultiThreadedExecutor", 2)
    node = run.node("/n")
    first, second = run.thread("MainThread"), run.thread("Thread-1")
    client = run.client(run.exclusive(node), "/clamp")
    left, other = run.timer(run.exclusive(node), "left", 1.0), run.timer(run.exclusive(node), "other", 1.0)
    run.start(left, first, 1.0)
    call = run.call("/clamp", 1.0, 2.0, entity=left)
    run.blocked(call, "/clamp", first, left, 1.0, 3.0)
    run.add(CallbackStarted(ns(2.0), client, second, call, 0, 0))
    run.end(client, second, 2.0)
    run.callback(other, second, 2.0, 1.0)
    told, timeline = said(run, 2.5), timeline_of(run, 2.5)
    there = "left has had its reply from /clamp since 2.000 s, but no thread is free to hand it over"
    assert told.text == there
    assert there in narration(timeline, ns(2.0))
    assert there not in narration(timeline, ns(1.5))
    assert said(run, 1.5).text == "left has been blocked in the call of /clamp for 500 ms"
    for at, why in ((1.5, "no reply for 500 ms"), (2.5, "its reply is there")):
        scene = scene_of(timeline, ns(at), ns(0.1))
        blocked = next(worker for worker in scene.workers if worker.blocked)
        assert blocked_texts(blocked, scene)[0] == f"blocked in call of /clamp, {why}"


def test_an_old_reply_is_not_told_while_the_program_waits_for_a_newer_one() -> None:
    run = Run()
    ask = run.timer(run.exclusive(run.node("/n")), "ask", 1.0)
    run.call("/part", 0.5, 1.5)
    run.call("/part", 2.2, 3.2, entity=ask)
    run.stop(4.0)
    assert call_note(timeline_of(run, 2.0), ns(2.0))
    assert call_note(timeline_of(run, 2.7), ns(2.7)) == ()
    assert said(run, 2.7).level is DiagnosisLevel.PENDING


def test_a_call_without_a_reply_is_not_told_as_nothing_waits() -> None:
    run = Run()
    tick = run.timer(run.exclusive(run.node("/n")), "tick", 1.0)
    run.callback(tick, run.thread("MainThread"), 1.0, 0.1)
    run.call("/x", 1.05, None, entity=tick)
    text = said(run, 4.05).text
    assert text.startswith("tick has no reply from /x for 3.0 s; no callback waits; ")


def test_where_nothing_waits_the_threads_that_were_needed_are_told() -> None:
    assert said(dummy_server_run(), 5.2).text.endswith("so far 2 of 2 threads were needed at once")
    assert said(split_groups_run(), 3.0).text == "nothing waits; so far 1 of 4 threads was needed at once"
    run = shared_group_run()
    assert said(run, 3.0).text == "nothing waits; one thread does all the work"
    run.add(OwnThreadAt(ns(1.0), 0, "worker", Doing.WAITS, "Event.wait", (("node.py", "work", 9),)))
    assert said(run, 3.0).text == "no callback waits; one thread runs all callbacks"


def test_executors_made_at_the_instant_of_the_first_callback_have_a_thread_each() -> None:
    run = Run()
    for _ in range(2):
        run.executor("SingleThreadedExecutor", 1)
    run.callback(run.timer(run.exclusive(run.node("/n")), "tick", 1.0), run.thread("MainThread"), 0.0, 0.1)
    assert said(run, 0.9).text == "nothing waits; so far 1 of 2 threads was needed at once"


def test_an_executor_that_a_callback_made_adds_no_thread() -> None:
    run = Run()
    run.executor("SingleThreadedExecutor", 1)
    run.callback(run.timer(run.exclusive(run.node("/n")), "tick", 1.0), run.thread("MainThread"), 0.0, 0.1)
    run.executor("SingleThreadedExecutor", 1, at=0.0)
    assert said(run, 0.9).text == "nothing waits; one thread does all the work"


def test_a_pool_of_one_thread_has_a_number_too() -> None:
    timeline = Timeline()
    timeline.extend(run_lesson("how-many-threads", 3.0, threads=1).events)
    assert "1 of 1 threads needed" in diagnosis_at(timeline, ns(2.95), Concurrency(timeline)).text


def test_the_threads_of_a_run_that_is_over_were_ever_needed() -> None:
    ended = Run()
    ended.over(1.0, "its time was up", failed=False)
    timeline = timeline_of(ended, 1.0)
    assert threads_needed(1, 4, ns(1.0), timeline) == "1 of 4 threads was ever needed at once"
    assert threads_needed(2, 4, ns(1.0), timeline) == "2 of 4 threads were ever needed at once"
    assert threads_needed(2, 4, ns(0.9), timeline) == "so far 2 of 4 threads were needed at once"


def test_a_timer_that_outlasts_its_period_waits_for_nobody_else() -> None:
    told = said(split_groups_run(), 9.4)
    assert told.text == (
        "timer_callback still runs, due 4.9 s ago; nothing else waits; 2 of 4 threads needed"
    )
    (run,) = diagnosis_row(told, (), "", 80)
    assert run.text.strip() == "· timer still runs, due 4.9 s ago; nothing else waits; 2 of 4 threads needed"
    assert told.at_length == f"{told.text.rpartition(';')[0]}; so far 2 of 4 threads were needed at once"
    assert told.level is DiagnosisLevel.PENDING


def test_a_wait_for_a_worker_names_what_the_workers_do() -> None:
    assert said(dummy_server_one_thread_run(), 5.0).text == (
        "timer_callback waits 2.0 s: the only thread runs service_callback"
    )


def test_a_wait_for_several_workers_names_what_keeps_most_of_them() -> None:
    run = Run()
    threads = [run.thread(f"ThreadPoolExecutor-0_{number}") for number in range(3)]
    run.executor("MultiThreadedExecutor", 3)
    group = run.reentrant(run.node("/n"))
    service, timer = run.service(group, "/s", "serve"), run.timer(group, "tick", 1.0)
    run.callback(timer, threads[0], 1.0)
    run.callback(service, threads[1], 1.1)
    run.callback(service, threads[2], 1.2)
    run.wait(timer, 2.0, None, Reason.NO_FREE_WORKER, workers_busy=True)
    assert said(run, 5.0).text == "tick waits 3.0 s: all 3 threads are busy with serve and tick"
    run.end(timer, threads[0], 6.0)
    assert said(run, 6.0).text == "tick waits 4.0 s: no thread is free for it: serve runs"


def test_a_wait_in_the_event_queue_names_what_runs_before() -> None:
    run = Run()
    thread = run.thread("MainThread")
    run.executor("EventsExecutor", 1)
    group = run.exclusive(run.node("/n"))
    scan, timer = run.subscription(group, "/scan", "scan"), run.timer(group, "tick", 1.0)
    run.callback(scan, thread, 1.0)
    run.wait(timer, 2.0, None, Reason.EVENT_QUEUE, scan, workers_busy=True)
    assert said(run, 5.0).text == "tick waits 3.0 s: the only thread runs scan"


def test_the_one_thread_of_an_executor_is_not_the_only_one_of_the_program() -> None:
    run = Run()
    thread = run.thread("MainThread")
    for _ in range(2):
        run.executor("SingleThreadedExecutor", 1)
    group = run.reentrant(run.node("/n"))
    slow, belt = run.timer(group, "slow", 9.0), run.timer(group, "belt", 0.5)
    run.callback(slow, thread, 1.0)
    run.wait(belt, 2.0, None, Reason.NO_FREE_WORKER, slow, workers_busy=True)
    assert said(run, 5.0).text == "belt waits 3.0 s: its only thread runs slow"


def test_a_node_that_nobody_spins_is_told() -> None:
    run = Run()
    run.wait(run.timer(run.exclusive(run.node("/n")), "tick", 1.0), 1.0, None, Reason.NOBODY_SPINS)
    assert said(run, 3.0).text == "tick waits 2.0 s: nobody spins its node"


def test_before_any_callback_the_node_is_starting() -> None:
    assert said(Run(), 0.0).text == "no callback yet: the node is starting"


def test_a_warning_of_the_engine_comes_first_for_a_while() -> None:
    run = shared_group_run()
    run.notice("node.py blocks outside the clock", 6.0)
    assert said(run, 7.0) == Diagnosis("node.py blocks outside the clock", DiagnosisLevel.TROUBLE)
    assert said(run, 12.0).text.startswith("odom_callback waits")


@pytest.mark.parametrize(("second", "late"), [(None, False), (2.2, True)])
def test_what_has_come_back_is_not_said_to_be_out(second: float | None, late: bool) -> None:
    run, text = Run(clock="real"), "tick has not come back for 1.5 s"
    timer = run.timer(run.reentrant(run.node("/n")), "tick", 1.0)
    run.callback(timer, run.thread("MainThread"), 1.0, 2.0)
    if second is not None:
        run.callback(timer, run.thread("other"), second)
    run.add(Notice(ns(2.5), Severity.WARN, text, timer, kind=NoticeKind.NO_PROGRESS))
    told = [said(run, at).text == text for at in (2.4, 2.5, 2.9, 3.0, 3.6, 3.8)]
    assert told == [False, True, True, False, False, late]


def test_what_the_engine_merely_mentions_does_not_hide_a_wait() -> None:
    run = shared_group_run()
    run.notice("the robot was reset", 6.0, Severity.INFO)
    assert said(run, 7.0).text.startswith("odom_callback waits")


def test_a_lost_engine_says_how_to_go_on() -> None:
    live = live_run(shared_group_run(), 5.0)
    live.over("the engine was killed by signal 9.")
    assert verdict_of(live) == Diagnosis(
        "engine lost: killed by signal 9; r runs again", DiagnosisLevel.TROUBLE
    )


@pytest.mark.parametrize(("failed", "weight"), [(False, DiagnosisLevel.FINE), (True, DiagnosisLevel.TROUBLE)])
def test_a_run_that_is_over_says_why(failed: bool, weight: DiagnosisLevel) -> None:
    run = shared_group_run()
    run.over(6.0, "its program returned", failed)
    assert verdict_of(live_run(run, 6.0)) == Diagnosis(
        "the run is over: its program returned; press r to run again", weight
    )


def test_looking_back_over_a_run_that_is_over_tells_of_that_moment() -> None:
    run = shared_group_run()
    run.over(13.0)
    told = verdict_of(live_run(run, 13.0), Playhead(at=ns(12.0)))
    assert told.text.startswith("odom_callback waits 8.0 s")


def test_a_call_is_followed_from_request_to_reply() -> None:
    timeline = timeline_of(dummy_server_run(), 10.0)
    assert call_note(timeline, ns(2.0)) == ()
    assert call_note(timeline, ns(5.15))[0] == "no reply for 2.6 s: /dummy_server_srv"
    assert call_note(timeline, ns(8.0))[0] == "/dummy_server_srv replied 'TURNING'"


def test_a_reply_does_not_stay_for_ever() -> None:
    timeline = timeline_of(split_groups_run(), 20.0)
    assert call_note(timeline, ns(8.0))[0] == "/motor_power replied success=True"
    assert call_note(timeline, ns(13.0)) == ()


def test_several_calls_without_reply_are_counted() -> None:
    run = dummy_server_run()
    run.call("/dummy_server_srv", 3.0)
    run.call("/dummy_server_srv", 4.0)
    assert call_note(timeline_of(run, 5.0), ns(4.55)) == (
        "no reply for 2.0 s: /dummy_server_srv and 2 more",
        "no reply for 2.0 s: /dummy_server_srv",
        "no reply for 2.0 s",
    )


def test_executors_are_written_as_code_would_make_them() -> None:
    assert executor_label(timeline_of(split_groups_run(), 1.0)) == "MultiThreadedExecutor(4)"
    assert executor_label(timeline_of(shared_group_run(), 1.0)) == "SingleThreadedExecutor"


@pytest.mark.parametrize("width", [80, 100, 140])
@pytest.mark.parametrize("note", [(), ("/motor_power replied success=True",)])
@pytest.mark.parametrize("problems", ["", "12 problems · d"])
def test_the_line_is_as_wide_as_the_screen(width: int, note: tuple[str, ...], problems: str) -> None:
    runs = diagnosis_row(said(shared_group_run(), 12.9), note, problems, width)
    assert sum(len(run.text) for run in runs) == width


@pytest.mark.parametrize(
    ("note", "shown"),
    [
        (("no reply for 3.2 s: /dummy_server_srv", "no reply for 3.2 s"), "no reply for 3.2 s"),
        (("/dummy_server_srv replied success=True",), ""),
    ],
)
def test_of_a_note_the_fullest_text_that_fits_is_shown(note: tuple[str, ...], shown: str) -> None:
    said = Diagnosis("odom waits for group A, which timer has held for 4.1 s", DiagnosisLevel.WAITS)
    line = "".join(run.text for run in diagnosis_row(said, note, "", 80))
    assert line.removeprefix(f" · {said.text}").strip() == shown


def test_where_nothing_is_wrong_a_reply_is_told_whole() -> None:
    said = Diagnosis("nothing waits; 2 of 2 threads were ever needed at once", DiagnosisLevel.FINE)
    line = "".join(run.text for run in diagnosis_row(said, ("/motor_power replied success=True",), "", 80))
    assert line.split("  ")[0] == " ✓ nothing waits"
    assert line.endswith(" /motor_power replied success=True ")


def test_a_shortened_sentence_keeps_the_names_of_files() -> None:
    text = (
        "1 of 5 checks fails. o opens lookup_in_a_callback.py; saving it checks it again after odom_callback"
    )
    line = "".join(run.text for run in diagnosis_row(Diagnosis(text, DiagnosisLevel.FINE), (), "", 96))
    assert "lookup_in_a_callback.py; saving it checks it again after odom" in line


@pytest.mark.parametrize(
    ("sentence", "shown"),
    [
        ("all 4 threads are busy with think and store", "all 4 threads are busy"),
        ("no thread is free for it: think and store run", "no thread is free"),
    ],
)
def test_a_sentence_that_is_too_long_says_what_is_busy_and_not_with_what(sentence: str, shown: str) -> None:
    told = Diagnosis(f"source waits 600 ms: {sentence}", DiagnosisLevel.WAITS)
    shorter = diagnosis_row(told, (), "12 problems · d", 72)[0].text.rstrip()
    assert shorter == f" · source waits 600 ms: {shown}"


def test_the_note_gives_way_to_the_diagnosis() -> None:
    runs = diagnosis_row(
        Diagnosis("w" * 70, DiagnosisLevel.TROUBLE), ("/motor_power replied success=True",), "", 80
    )
    assert "motor_power" not in "".join(run.text for run in runs)


def test_a_sentence_that_stays_is_shown_whole_on_several_lines() -> None:
    sentence = "the run is over: " + "word " * 30 + "press r to run again"
    rows = diagnosis_rows(Diagnosis(sentence, DiagnosisLevel.TROUBLE, stays=True), ("a note",), "", 80)
    shown = ["".join(run.text for run in row) for row in rows]
    assert len(shown) == 3
    assert {len(line) for line in shown} == {80}
    assert " ".join(" ".join(shown).replace("!", " ").split()) == sentence


def test_a_sentence_too_long_for_its_lines_says_so() -> None:
    sentence = f"the run is over: {'word ' * 80}"
    rows = diagnosis_rows(Diagnosis(sentence, DiagnosisLevel.TROUBLE, stays=True), (), "", 80)
    assert len(rows) == 4
    assert "".join(run.text for run in rows[-1]).rstrip().endswith("word …")


def test_a_reply_is_told_whole_where_further_clauses_can_be_left_out() -> None:
    well = Diagnosis("nothing waits; one thread does all the work", DiagnosisLevel.FINE)
    row = diagnosis_row(well, ("/sensors replied 'picture 5.900 s, scan 5.750 s'",), "", 80)
    line = "".join(run.text for run in row)
    assert line.startswith(" ✓ nothing waits  ")
    assert line.endswith("  /sensors replied 'picture 5.900 s, scan 5.750 s' ")


def test_a_sentence_of_the_moment_keeps_to_one_line() -> None:
    assert len(diagnosis_rows(Diagnosis("word " * 60, DiagnosisLevel.TROUBLE), (), "", 80)) == 1


def told_of(run: Run, until: float) -> tuple[ExplainedFinding, ...]:
    watch = FindingsMonitor(timeline_of(run, until))
    watch.update()
    return watch.findings


def line(
    diagnosis: Diagnosis, width: int, note: tuple[str, ...] = (), problems: str = "7 problems · d"
) -> str:
    return "".join(run.text for run in diagnosis_row(diagnosis, note, problems, width))


def test_a_moment_that_is_well_tells_of_the_runs_worst_problem() -> None:
    told = with_worst_problem(said(shared_group_run(), 3.0), told_of(shared_group_run(), 15.0))
    what = "odom_callback and scan_callback waited up to 11.0 s: group A was held by timer_callback"
    assert told.level is DiagnosisLevel.TROUBLE
    assert told.text.startswith(f"at 4.0 s: {what}")
    assert told.at_length.startswith(f"group starvation at 4.0 s: {what}")


def test_of_a_past_moment_no_later_problem_is_told() -> None:
    moment, findings = said(shared_group_run(), 3.0), told_of(shared_group_run(), 15.0)
    assert with_worst_problem(moment, findings, at=ns(3.0)) == moment
    assert "waited up to" in with_worst_problem(moment, findings, at=ns(15.0)).text
    many = [replace(each, finding=replace(each.finding, count=2)) for each in findings]
    told = with_worst_problem(moment, many, at=ns(15.0))
    counts_on = "what is counted goes on after a past moment, however short the line"
    assert "whole run: " in line(told, 60), counts_on
    assert "in the whole run: " in line(told, 200), counts_on
    assert with_worst_problem(moment, many).text.startswith("at 4.0 s: ")


def test_a_request_that_waits_for_the_call_before_it_is_told_as_that() -> None:
    run = Run()
    serve = run.service(run.exclusive(run.node("/n")), "/serve", "serve")
    run.callback(serve, run.thread("MainThread"), 1.0, 8.0)
    run.wait(serve, 2.0, 9.0, Reason.GROUP_HELD, serve)
    told = said(run, 6.7)
    assert told.text.startswith("serve still runs, and the next request has waited 4.7 s for it")


def test_in_80_columns_a_problem_keeps_its_reason() -> None:
    told = with_worst_problem(said(shared_group_run(), 3.0), told_of(shared_group_run(), 15.0))
    shown = line(told, 80, problems="1 problem · d")
    assert shown.startswith(" ! odom and scan waited up to 11.0 s: group A was held by timer ")


_FOUR_CALLS = (2.55, 10.55, 10.6, 10.65)


@pytest.mark.parametrize(
    ("lesson", "calls", "shown"),
    [
        ("reentrant-2-threads", _FOUR_CALLS, "timer waited 4.6 s: both threads ran SetBool (node.py:97)"),
        ("no-groups-at-all", _FOUR_CALLS, "timer waited 4.5 s: group A was held by SetBool (node.py:97)"),
        ("cancel-never-served", (1.0,), "/fetch_it server waited 5.0 s: its only thread ran execute"),
        ("lookup-in-a-callback", (2.03,), "lower waited 1.0 s in lookup_transform() (node.py:60)"),
        ("lock-or-group", (), "blink waited 750 ms: all 4 threads ran count_with_lock"),
        ("stale-data", (), "decide lost 70 messages while its calls ran (node.py:56)"),
        ("three-cures", (), "ask_and_await took 1.5 s with a period of 1.0 s (node.py:71)"),
    ],
)
def test_in_80_columns_no_lesson_s_problem_is_cut_within_a_clause(
    lesson: str, calls: tuple[float, ...], shown: str
) -> None:
    timeline = Timeline()
    timeline.extend(event for event in run_lesson(lesson, 28.0, *calls).events if event.t < ns(27.0))
    monitor = FindingsMonitor(timeline)
    monitor.update()
    told = with_worst_problem(Diagnosis("", DiagnosisLevel.FINE), monitor.findings)
    row = line(told, 80, problems="1 problem · d")
    assert row.startswith(f" ! {shown}  ")


@pytest.mark.parametrize(
    ("lesson", "shown"),
    [
        ("spin-inside-a-callback", "node /asker left its executor, which no longer serves it"),
        ("qos-never-matches", "RELIABILITY does not match (node.py:51)"),
        ("synchroniser-never-fires", "at 2.0 s: the stamps are at least 20 ms apart (node.py:67)"),
        ("clock-set-back", "done_at was kept when sim time was set back by 950 ms"),
    ],
)
def test_in_80_columns_a_long_sentence_has_its_reason_first(lesson: str, shown: str) -> None:
    timeline = run_lesson(lesson, 3.0, 1.0).timeline
    monitor = FindingsMonitor(timeline)
    monitor.update()
    told = with_worst_problem(Diagnosis("", DiagnosisLevel.FINE), monitor.findings)
    assert line(told, 80, problems="1 problem · d").startswith(f" ! {shown}  ")


@pytest.mark.parametrize(
    ("lesson", "rule"),
    [("synchroniser-never-fires", "never-synchronised"), ("clock-set-back", "times-kept")],
)
def test_a_problem_that_one_event_shows_is_told_of_past_moments_from_that_on(lesson: str, rule: str) -> None:
    monitor = FindingsMonitor(run_lesson(lesson, 3.0, 1.0).timeline)
    monitor.update()
    (found,) = (each for each in monitor.findings if each.finding.rule.id == rule)
    calm, at = Diagnosis("", DiagnosisLevel.FINE), found.finding.at
    assert with_worst_problem(calm, [found], at=at - 1) is calm
    assert with_worst_problem(calm, [found], at=at) == with_worst_problem(calm, [found])


def test_a_sentence_that_does_not_fit_ends_with_a_clause() -> None:
    what = "deadlock: pick waits for /gripper for ever; the reply of /gripper can never be taken in"
    deadlock = Diagnosis(f"at 1.0 s: {what}", DiagnosisLevel.TROUBLE, time="at 1.0 s: ")
    assert line(deadlock, 80).rstrip().startswith(" ! at 1.0 s: deadlock: pick waits for /gripper for ever  ")
    assert "…" in line(deadlock, 40)


@pytest.mark.parametrize(
    ("width", "shown"),
    [
        (90, "at 1.0 s: deadlock: pick waits for /gripper for ever (node.py:51)"),
        (60, "deadlock: pick waits for /gripper for ever (node.py:51)"),
        (56, "deadlock: pick waits for /gripper for ever, line 51"),
        (50, "deadlock: pick waits for /gripper for ever"),
        (40, "line 51: deadlock: pick waits for /g…"),
    ],
)
def test_a_problem_names_its_line_before_all_that_can_be_left_out(width: int, shown: str) -> None:
    place = CodeLocation("/home/me/node.py", 51, 51)
    text = "at 1.0 s: deadlock: pick waits for /gripper for ever"
    problem = Diagnosis(text, DiagnosisLevel.TROUBLE, time="at 1.0 s: ", place=place)
    assert line(problem, width, problems="").strip() == f"! {shown}"


def test_a_line_before_a_sentence_that_is_cut_is_not_named_again_in_it() -> None:
    text = "at 3.3 s: work computes in the loop of line 23 and has not come back for 1.5 s"
    place = CodeLocation("/home/me/node.py", 23, 23)
    told = Diagnosis(text, DiagnosisLevel.TROUBLE, place=place, time="at 3.3 s: ")
    assert line(told, 60, problems="").rstrip() == " ! line 23: work computes and has not come back for 1.5 s"


def test_a_line_that_the_sentence_names_is_not_named_again() -> None:
    place = CodeLocation("/home/me/node.py", 51, 51)
    problem = Diagnosis("tick is in the loop of line 51", DiagnosisLevel.TROUBLE, place=place)
    assert line(problem, 90, problems="").strip() == "! tick is in the loop of line 51"


def test_a_wait_that_never_ends_is_told_whatever_else_waits() -> None:
    moment = said(shared_group_run(), 12.9)
    (worst, *_) = told_of(shared_group_run(), 15.0)
    explanation = replace(worst.explanation, what="deadlock: tick waits for ever", for_ever=True)
    endless = replace(worst, explanation=explanation)
    told = with_worst_problem(moment, [worst, endless], "R starts over")
    assert told.text == "at 4.0 s: deadlock: tick waits for ever"
    assert told.at_length.endswith("; R starts over")
    stalled = replace(moment, text="tick has not come back for 1.5 s", stays=True, is_stall=True)
    assert with_worst_problem(stalled, [worst, endless], "R starts over") == told
    assert with_worst_problem(stalled, [worst]) is stalled


def test_a_wait_that_ends_by_its_timeout_is_told_calmly() -> None:
    moment = said(shared_group_run(), 12.9)
    (worst, *_) = told_of(shared_group_run(), 15.0)
    explanation = replace(worst.explanation, what="tick waits in vain until 9.0 s", until=ns(9.0))
    told = with_worst_problem(moment, [worst, replace(worst, explanation=explanation)], "R starts over")
    assert told.text == "at 4.0 s: tick waits in vain until 9.0 s"
    assert told.level is DiagnosisLevel.WAITS
    assert "starts over" not in told.at_length


def test_a_moment_that_is_not_well_is_told_of_itself() -> None:
    problems = told_of(shared_group_run(), 15.0)
    for moment in (12.9, 4.4):
        assert with_worst_problem(said(shared_group_run(), moment), problems) == said(
            shared_group_run(), moment
        )


def test_how_a_run_ended_and_how_to_go_on_is_told_whatever_went_wrong() -> None:
    ended = shared_group_run()
    ended.over(15.0, "its program returned", failed=False)
    moment = verdict_of(live_run(ended, 15.0))
    told = with_worst_problem(moment, told_of(ended, 15.0))
    assert told == replace(moment, level=DiagnosisLevel.WAITS), "a tick beside a number of problems"
    assert with_worst_problem(moment, []) is moment


def test_an_exception_that_spin_has_not_raised_yet_gets_no_tick() -> None:
    run = Run()
    thread = run.thread("ThreadPoolExecutor-0_0")
    timer = run.timer(run.exclusive(run.node("/n")), "weigh", 3.0)
    run.start(timer, thread, 9.0)
    run.fail(timer, thread, 9.0, "ValueError: '???'")
    told = said(run, 9.5)
    assert (told.text, told.level) == ("at 9.0 s: weigh raised ValueError: '???'", DiagnosisLevel.WAITS)
    assert said(run, 15.0).level is DiagnosisLevel.FINE


def test_a_good_run_is_told_as_it_was() -> None:
    moment = said(split_groups_run(), 12.0)
    assert with_worst_problem(moment, told_of(split_groups_run(), 20.0)) is moment


def test_a_problem_of_the_whole_run_is_told_without_a_time() -> None:
    rule = next(rule for rule in RULES if rule.id == "qos-mismatch")
    found = ExplainedFinding(
        Finding(rule, 0, 1),
        RuleWeight.PROBLEM,
        Explanation("scan hears nothing", "why", "cure", None),
        rule.id,
    )
    told = with_worst_problem(Diagnosis("nothing waits", DiagnosisLevel.FINE), [found])
    assert (told.text, told.at_length) == ("scan hears nothing", "qos mismatch: scan hears nothing")


def test_the_line_says_at_narrow_and_wide_what_fits() -> None:
    waits = said(shared_group_run(), 12.9)
    assert line(waits, 80) == (
        " ! odom_callback waits 8.9 s: group A is held by timer_callback  7 problems · d "
    )
    assert line(waits, 100) == (
        " ! odom_callback waits 8.9 s: group A is held by timer_callback; 1 more waits        7 problems · d "
    )
    assert line(waits, 140, note=("/motor_power replied success=True",)).endswith(
        "waits            /motor_power replied success=True   7 problems · d "
    )


def test_the_number_of_problems_is_there_however_long_the_sentence() -> None:
    long = Diagnosis("w" * 200, DiagnosisLevel.TROUBLE)
    assert line(long, 80) == f" ! {'w' * 59}…  7 problems · d "
    assert line(long, 80, note=("/motor_power replied success=True",)).endswith("…  7 problems · d ")


def test_a_sentence_that_stays_leaves_room_for_the_number_of_problems() -> None:
    sentence = "the run is over: " + "word " * 30 + "press r to run again"
    rows = diagnosis_rows(Diagnosis(sentence, DiagnosisLevel.FINE, stays=True), (), "7 problems · d", 80)
    shown = ["".join(run.text for run in row) for row in rows]
    assert {len(each) for each in shown} == {80}
    assert shown[0].endswith("  7 problems · d ")
    words = " ".join([shown[0].removesuffix("  7 problems · d "), *shown[1:]]).replace("✓", " ").split()
    assert " ".join(words) == sentence
