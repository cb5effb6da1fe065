"""At any moment of any run, all panes say the same."""

import re
from functools import cache
from pathlib import Path
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cbtui.looks.theme import Charset
from cbtui.runs.setup.lesson_setup import setup_to_judge
from cbtui.widgets.choice import kept_of
from cbtui.widgets.code.marks import marks_at
from cbtui.widgets.code.source_files import SourceFiles
from cbtui.widgets.diagnosis import DiagnosisLevel, diagnosis_at
from cbtui.widgets.factory.painter import FactoryPainter
from cbtui.widgets.factory.scene import FactoryScene, scene_of
from cbtui.widgets.factory.texts import belt_details, headlines, wait_texts
from cbtui.widgets.lanes.details import details_of
from cbtui.widgets.lanes.painter import LanePainter
from cbtui.widgets.lanes.rows import GroupLane, MemberLane, SoleLane, all_lanes
from cbtui.widgets.lanes.service_calls import LatestCalls
from cbtui.widgets.lanes.status import LaneStatus
from cbtui.widgets.narrator.narration import narration
from cbtui.widgets.scene import paint_scene
from lessons.catalogue import lessons
from lessons.description import Actor
from lessons.lesson import Lesson
from sim.quantities.durations import duration
from sim.trace.descriptions import name_of, why_waiting
from sim.trace.events import (
    CallbackEnded,
    CallbackStarted,
    ChoiceAsked,
    EntityReady,
    GroupId,
    QosMismatched,
    Reason,
    WaitEnded,
    WaitStarted,
)
from sim.trace.figures.comparison import compare
from sim.trace.figures.concurrency import Concurrency
from sim.trace.figures.summary import summarise
from sim.trace.figures.waiting import (
    WORTH_TELLING,
    had_other_reasons,
    wait_told,
    waited_so_far,
    waits_at,
    waits_for_others,
    waits_since,
)
from sim.trace.model import Window
from sim.trace.timeline import Timeline
from tests.support.builder import ns
from tests.support.engine_runs import run_to_end
from tests.support.runs import Run, dummy_server_run, shared_group_run, split_groups_run
from tests.widgets.pictures import plain, told

FILES = SourceFiles(Path("node.py"), "", {})
_STEPS = (CallbackStarted, CallbackEnded, EntityReady, WaitStarted, WaitEnded)
_RUNS = (shared_group_run, split_groups_run, dummy_server_run)


@cache
def timeline_of(number: int) -> Timeline:
    timeline = Timeline()
    timeline.extend(_RUNS[number]().events)
    return timeline


def waiting_by_lanes(timeline: Timeline, at: int) -> dict[GroupId, int]:
    """How many callbacks wait in each group that has a lane of its own, by the status of that."""
    moment = timeline.moment(at)
    status = LaneStatus(timeline, Window(0, at + 1), moment, LatestCalls(timeline), Charset.BRAILLE, 25)
    lanes = [lane for lane in all_lanes(timeline, "") if isinstance(lane, GroupLane)]
    texts = {lane.group.id: status.of(lane, None).text for lane in lanes}
    found = {group: re.search(r"(\d+) waits?$", text) for group, text in texts.items()}
    return {group: int(match[1]) if match else 0 for group, match in found.items()}


@given(st.integers(0, len(_RUNS) - 1), st.integers(0, ns(15.0)))
@settings(deadline=None, max_examples=60)
def test_all_panes_say_the_same_of_any_moment(number: int, at: int) -> None:
    timeline = timeline_of(number)
    assert_panes_agree(timeline, min(at, timeline.end), FILES)


@pytest.mark.parametrize("number", range(2))
@pytest.mark.parametrize("after", [0, ns(0.003), ns(0.01)])
def test_all_panes_say_the_same_of_the_beginnings_of_waits(number: int, after: int) -> None:
    timeline = timeline_of(number)
    whole = Window(0, timeline.end)
    begun = {wait.since for entity in timeline.entities for wait in timeline.waits_of(entity, whole)}
    assert begun
    for since in sorted(begun)[:: max(1, len(begun) // 20)]:
        assert_panes_agree(timeline, min(since + after, timeline.end), FILES)


@pytest.mark.slow
@pytest.mark.parametrize("lesson", lessons(), ids=lambda lesson: lesson.id)
def test_all_panes_say_the_same_of_any_moment_of_a_lesson(lesson: Lesson) -> None:
    timeline = Timeline()
    timeline.extend(run_to_end(setup_to_judge(lesson)).events)
    files = SourceFiles(lesson.node_path, lesson.node_path.read_text(), {})
    moments = Random(lesson.id)
    for _ in range(40):
        assert_panes_agree(timeline, moments.randrange(timeline.end), files)


@pytest.mark.parametrize("is_live", [True, False], ids=["live", "looking back"])
def test_all_panes_say_the_same_of_each_step_of_a_queue_that_is_always_full(is_live: bool) -> None:
    lesson = next(each for each in lessons() if each.id == "stale-data")
    files = SourceFiles(lesson.node_path, lesson.node_path.read_text(), {})
    timeline, events = Timeline(), run_to_end(setup_to_judge(lesson)).events
    if not is_live:
        timeline.extend(events)
    for event in events:
        if is_live:
            timeline.extend([event])
        if ns(4.0) <= event.t <= ns(5.7) and isinstance(event, _STEPS):
            assert_panes_agree(timeline, event.t, files)
            if is_live:
                assert_choice_agrees(timeline)


def test_a_subscription_slower_than_its_messages_tells_everywhere_how_long_the_next_one_has_waited() -> None:
    run = Run()
    thread = run.thread("MainThread")
    scan = run.subscription(run.exclusive(run.node("/n")), "/scan", "scan_callback", depth=100)
    for place in range(30):
        run.message(scan, 1.0 + place / 10)
    for since, begun in ((1.1, 1.0), (2.0, 2.0), (3.0, 3.0)):
        run.wait(scan, since, begun + 1, Reason.GROUP_HELD, scan)
        run.callback(scan, thread, begun, 1.0)
    timeline = told(run, until=4.0)
    at = ns(3.5)
    wait = timeline.moment(at).waiting[scan]
    belt = scene_of(timeline, at, ns(0.1)).areas[0].belts[0]
    assert diagnosis_at(timeline, at, Concurrency(timeline)).text.startswith(
        "scan_callback still runs, and the next message has waited 2.2 s for it"
    )
    assert wait_texts(belt, timeline, at)[0] == "waits 2.2 s: its last call still runs"
    assert "next in its queue since 1.300 s" in details_of(timeline, wait, at).facts
    third = timeline.spans_of(scan, Window(ns(3.0), ns(3.1)))[-1]
    assert "waited 1.8 s: its last call still ran" in details_of(timeline, third, at).facts
    (figures,) = summarise(timeline).callbacks
    assert figures.longest_wait is not None
    assert figures.longest_wait.length == ns(2.7)
    (pair,) = compare(timeline, timeline, Window(0, timeline.end)).callbacks
    assert pair.first is not None
    assert pair.first.longest_wait == ns(2.7)


def test_a_reason_is_blamed_for_no_more_than_the_time_since_it_began() -> None:
    run = Run()
    run.executor("MultiThreadedExecutor", 2)
    group, first, second = run.exclusive(run.node("/n")), run.thread("Pool-0_0"), run.thread("Pool-0_1")
    store, report = run.subscription(group, "/n", "store", depth=9), run.timer(group, "report", 1.0)
    think = run.timer(run.reentrant(run.node("/m")), "think", 1.0)
    for at in (1.0, 1.5):
        run.message(store, at)
    run.callback(think, first, 0.5, 4.0)
    run.callback(store, second, 1.0, 1.0)
    run.wait(store, 1.5, 2.0, Reason.GROUP_HELD, store)
    run.callback(think, second, 2.0, 0.5)
    run.wait(store, 2.0, 2.5, Reason.NO_FREE_WORKER, think, workers_busy=True)
    run.callback(report, second, 2.5, 1.0)
    run.wait(store, 2.5, 3.5, Reason.GROUP_HELD, report)
    timeline = told(run, until=3.0)
    for seconds, lasted in ((2.2, "700 ms"), (3.0, "1.5 s")):
        at = ns(seconds)
        moment, belt = timeline.moment(at), scene_of(timeline, at, ns(0.1)).areas[0].belts[0]
        assert waited_so_far(moment.waiting[store], moment, timeline) == f"{lasted}, now"
        assert f"waits {lasted}, now: " in diagnosis_at(timeline, at, Concurrency(timeline)).text
        assert wait_texts(belt, timeline, at)[0].startswith(f"waits {lasted}, now: ")
        assert any(
            "store has waited since 1.500 s, 1 queued, now: " in line for line in narration(timeline, at)
        )


def test_a_timer_that_is_free_to_run_is_told_everywhere_before_the_executor_lets_it_in() -> None:
    run = Run()
    group, thread = run.exclusive(run.node("/n")), run.thread("MainThread")
    tick, pack = run.timer(group, "tick", 0.25), run.timer(group, "pack", 5.0)
    run.callback(tick, thread, 1.0, 0.0)
    run.wait(tick, 1.25, None, Reason.GROUP_HELD, pack)
    run.callback(pack, thread, 1.25, 1.9)
    timeline = told(run)
    assert narration(timeline, ns(3.15))[1] == "tick is ready for 1.9 s: it is free to run"
    assert_panes_agree(timeline, ns(3.15), FILES)
    belts = {belt.entity.id: belt for belt in scene_of(timeline, ns(3.15), ns(0.1)).areas[0].belts}
    assert ("is due", False) in belt_details(belts[tick], ns(3.15))
    first = scene_of(timeline, ns(1.25), ns(0.1)).areas[0].belts
    belt = next(belt for belt in first if belt.entity.id == tick)
    assert wait_texts(belt, timeline, ns(1.25))[0].startswith("is due: "), "and not late 0 s"


def test_between_two_calls_a_queue_is_not_told_as_nothing_that_waits() -> None:
    run = Run()
    scan = run.subscription(run.exclusive(run.node("/n")), "/scan", "scan_callback", depth=100)
    for place in range(9):
        run.message(scan, 1.0 + place / 10)
    run.wait(scan, 1.1, 2.0, Reason.GROUP_HELD, scan)
    run.callback(scan, run.thread("MainThread"), 1.0, 1.0)
    timeline = told(run, until=2.0)
    assert diagnosis_at(timeline, ns(2.0), Concurrency(timeline)).text.startswith(
        "scan_callback is next, and the next message has waited 900 ms for it"
    )
    runs, ended = narration(timeline, ns(1.5)), narration(timeline, ns(2.0))
    assert runs[1] == "scan_callback has 5 queued, the next for 400 ms: its last call still runs"
    assert ended == (
        "2.000 s: scan_callback returns after 1.0 s, group A is free",
        "scan_callback has 8 queued, the next for 900 ms: it is free to run",
    )


@pytest.mark.parametrize("number", range(2))
@pytest.mark.parametrize("is_live", [True, False], ids=["live", "looking back"])
def test_a_wait_counts_in_every_pane_from_the_moment_at_which_it_begins(number: int, is_live: bool) -> None:
    events, timeline = _RUNS[number]().events, Timeline()
    begun = {each.t for each in events if isinstance(each, WaitStarted)}
    if not is_live:
        timeline.extend(events)
    counted = 0
    for at in sorted({each.t for each in events}):
        if is_live:
            timeline.extend(each for each in events if each.t == at)
        if at in begun:
            assert_panes_agree(timeline, at, FILES)
            moment = timeline.moment(at)
            waits = list(waits_at(moment, timeline))
            lasting = [each for each in waits if each.end is None or each.end >= at + WORTH_TELLING]
            assert all(wait_told(each.entity, moment, timeline) == each for each in lasting)
            counted += len(lasting)
    assert counted


def assert_panes_agree(timeline: Timeline, at: int, files: SourceFiles) -> None:
    """Compare what lanes, factory, scene, code and diagnosis line say of a moment."""
    moment, scene = timeline.moment(at), scene_of(timeline, at, ns(0.1))
    waits = waits_for_others(moment, timeline)
    assert {wait.entity for wait in scene.waits()} == {wait.entity for wait in waits}
    by_lanes = waiting_by_lanes(timeline, at)
    in_factory = {area.group.id: area.waiting for area in scene.areas}
    assert by_lanes == {group: in_factory[group] for group in by_lanes}
    assert_headline_agrees(scene)
    assert_short_waits_count_nowhere(timeline, at, files)
    assert_turns_agree(scene, files)
    assert_lanes_agree(timeline, at)
    told = diagnosis_at(timeline, at, Concurrency(timeline))
    in_code = {
        mark.entity: mark.texts[0] for marks in marks_at(timeline, at, files).values() for mark in marks
    }
    belts = {belt.entity.id: belt for area in scene.areas for belt in area.belts}
    for wait in waits:
        reasons = {wait_texts(belts[wait.entity], timeline, at)[0]}
        is_running = any(span.entity == wait.entity for span in moment.running.values())
        if (callback := timeline.entities[wait.entity].callback) and not is_running:
            actor = Actor(figure="hand", follows=callback)
            reasons.add(plain(paint_scene([actor], timeline, at, 120, 2, Charset.BRAILLE)))
        if (
            wait.entity in in_code and not is_running
        ):  # what rclpy makes for itself is in no code of the lesson's
            reasons.add(in_code[wait.entity])
        if wait == waits[0] and not told.stays:
            reasons.add(told.text)
        for text in reasons:
            since = waits_since(wait, moment.queues[wait.entity], timeline)
            assert duration(at - since) in text
            assert (", now" in text) == had_other_reasons(wait, since, at, timeline)
            is_held = wait.reason is Reason.GROUP_HELD
            assert ("held by" in text) == is_held
            assert name_of(wait.holder, timeline) in text or not is_held
    if told.stays:
        return
    calls = LatestCalls(timeline)
    has_no_reply = any("no reply" in calls.summary(each.service, at) for each in calls.latest)
    is_well = not moment.waiting and not moment.blocked and not has_no_reply
    if not timeline.own_threads_at(at):
        assert (told.level is DiagnosisLevel.FINE) == ("nothing waits" in told.text) <= is_well
    if waits:
        more = re.search(r"; (\d+) more", told.at_length)
        assert 1 + (int(more[1]) if more else 0) == len(waits)
    assert len(scene.workers) <= max(1, sum(executor.threads for executor in timeline.executors.values()))


def assert_lanes_agree(timeline: Timeline, at: int) -> None:
    """Compare the hatching and the details of waits with what runs."""
    moment, span = timeline.moment(at), Window(max(0, at - ns(2.0)), at)
    judged = {wait.entity: wait for wait in waits_at(moment, timeline)}
    picture = LanePainter().paint(timeline, span, at, 200, 40)
    hatched = {
        lane.entity.id: plain([row])
        for lane, row in zip(picture.lanes, picture.rows, strict=False)
        if isinstance(lane, MemberLane | SoleLane)
    }
    for entity, wait in moment.waiting.items():
        told, details = hatched.get(entity, ""), details_of(timeline, wait, at)
        now = judged.get(entity)
        assert (" waited" in details.title) == (now is None)
        assert now or not re.search(r"\bwaits ", told)
        if now and now.reason is Reason.GROUP_HELD and not now.is_for_own_call:
            assert details.facts[1].endswith(f"held by {name_of(now.holder, timeline)}")
            held = re.search(r"waits .* held by (\w+)", told)
            assert held is None or name_of(now.holder, timeline).startswith(held[1])


def assert_choice_agrees(timeline: Timeline) -> None:
    """Compare why a choice's other callbacks may not go on with what runs."""
    moment = timeline.moment(timeline.end)
    kept = "; ".join(kept_of(ChoiceAsked(timeline.end, 0, (), (), (), False, ()), timeline))
    judged = {wait.entity: why_waiting(wait, timeline) for wait in waits_at(moment, timeline)}
    for entity in {*moment.waiting, *judged}:
        assert f"{name_of(entity, timeline)} is ready: {judged.get(entity, 'it is free to run')}" in kept


def assert_turns_agree(scene: FactoryScene, files: SourceFiles) -> None:
    """Compare what the narrator says of those that wait for no other one with belts, code and scene."""
    timeline, at = scene.timeline, scene.now
    belts = [belt for area in scene.areas for belt in area.belts]
    for narrated in "; ".join(narration(timeline, at, stepped=True)).split("; "):
        of_it = [belt for belt in belts if narrated.startswith(f"{belt.entity.spoken_name} ")]
        texts = [wait_texts(belt, timeline, at)[:1] for belt in of_it]
        if narrated.endswith(": it is free to run"):
            assert () in texts
            ticks = [belt.tick for belt in of_it if belt.tick is not None and belt.wait is None]
            assert all(tick.due is not None and tick.due <= at for tick in ticks) or len(of_it) > 1
            ids = {belt.entity.id for belt in of_it}
            marks = (mark for line in marks_at(timeline, at, files).values() for mark in line)
            assert len(of_it) > 1 or not any("waits" in mark.texts[0] for mark in marks if mark.entity in ids)
            actors = [Actor(figure="hand", follows=belt.entity.callback) for belt in of_it[:1]]
            assert " waits " not in plain(paint_scene(actors, timeline, at, 120, 2, Charset.BRAILLE))
        elif waited := re.search(r"the next for ([\d.]+) (m?s): its last call still runs$", narrated):
            is_long = waited[2] == "s" or float(waited[1]) >= 10
            assert not is_long or any("its last call still runs" in text for (text,) in filter(None, texts))
            assert "no callback waits for another" not in headlines(scene)[0].text or not is_long


def assert_short_waits_count_nowhere(timeline: Timeline, at: int, files: SourceFiles) -> None:
    """A wait that is over at once counts in no pane, as the diagnosis line does not count it."""
    moment, whole = timeline.moment(at), Window(0, timeline.end + 1)
    last = {
        (each, wait.since): wait.end for each in moment.waiting for wait in timeline.waits_of(each, whole)
    }
    short = {
        each.entity: each
        for each in moment.waiting.values()
        if (end := last[each.entity, each.since]) is not None
        if max(at, end) - waits_since(each, moment.queues[each.entity], timeline) < WORTH_TELLING
    }
    in_code = [mark for marks in marks_at(timeline, at, files).values() for mark in marks]
    assert not any("waits" in mark.texts[0] for mark in in_code if mark.entity in short)
    belts = [belt for area in scene_of(timeline, at, ns(0.1)).areas for belt in area.belts]
    assert not any(wait_texts(belt, timeline, at) for belt in belts if belt.entity.id in short)
    callbacks = {timeline.entities[each].callback for each in short}
    callbacks -= {"", *(each.callback for each in timeline.entities.values() if each.id not in short)}
    actors = [Actor(figure="hand", follows=each) for each in callbacks]
    assert " waits " not in plain(paint_scene(actors, timeline, at, 120, 2, Charset.BRAILLE))
    status = LaneStatus(timeline, Window(0, at + 1), moment, LatestCalls(timeline), Charset.BRAILLE, 25)
    for lane in all_lanes(timeline, ""):
        if isinstance(lane, MemberLane | SoleLane) and lane.entity.id in short:
            assert "late" not in status.of(lane, None).text
            assert "waits" not in details_of(timeline, short[lane.entity.id], at).title
    told = "; ".join(narration(timeline, at, stepped=True))
    names = (timeline.entities[each].spoken_name for each in short)
    assert not any(f"{name} {waits}" in told for name in names for waits in ("waits", "has waited"))


def assert_headline_agrees(scene: FactoryScene) -> None:
    """Compare the factory's headline with what its belts and areas say."""
    belts = [wait_texts(belt, scene.timeline, scene.now) for area in scene.areas for belt in area.belts]
    waits = [texts[0] for texts in belts if texts]
    trouble = headlines(scene)[0].trouble
    told = re.search(r"(\d+) callbacks? waits? for a worker", trouble)
    assert (int(told[1]) if told else 0) == sum("no free worker" in text for text in waits)
    counts = re.findall(r"(\d+) callbacks? waits?", trouble)
    assert sum(map(int, counts)) == sum(area.waiting for area in scene.areas)
    if "no callback waits" in headlines(scene)[0].text:
        assert all("its last call" in text for text in waits)


@pytest.mark.parametrize(("at", "told_then"), [(0.5, False), (1.5, True), (2.5, False)])
@pytest.mark.parametrize("width", [58, 78])
@pytest.mark.parametrize(("policy", "word"), [("RELIABILITY", "QoS mismatch"), ("TYPE", "type mismatch")])
def test_lane_and_factory_tell_of_a_publisher_that_does_not_match_until_something_comes(
    policy: str, word: str, at: float, told_then: bool, width: int
) -> None:
    run = Run()
    hear = run.subscription(run.exclusive(run.node("/n")), "/t", "hear")
    run.add(QosMismatched(ns(1.0), "/t", 1, hear, policy))
    run.message(hear, 2.0)
    run.callback(hear, run.thread("MainThread"), 2.0, 0.1)
    timeline = told(run)
    lanes = plain(LanePainter().paint(timeline, Window(0, ns(10)), ns(at), 80, 8).rows)
    factory = plain(FactoryPainter().paint(timeline, ns(at), width, 14))
    assert [word in each for each in (lanes, factory)] == [told_then] * 2
