"""The window that lists what the rules found, and the way from there to the moment and the code."""

from collections.abc import AsyncIterator, Sequence
from contextlib import asynccontextmanager
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from threading import Event
from time import monotonic
from typing import Any

import pytest
from msgspec import structs
from textual.events import Key
from textual.pilot import Pilot
from textual.widgets import OptionList, Static

from cbtui.app import CbtuiApp
from cbtui.keys.keymap import STANDARD, Keymap
from cbtui.looks.theme import Charset
from cbtui.runs.judged.cures import Verdict
from cbtui.runs.live.findings import ExplainedFinding, FindingsMonitor
from cbtui.screens.lesson import LessonScreen
from cbtui.screens.linear.narrative import told_finding
from cbtui.screens.parts.cures import CureTrial
from cbtui.screens.replay import ReplayScreen
from cbtui.screens.windows.diagnoses import DiagnosesScreen
from cbtui.screens.windows.finding_texts import details_of, problems_note, row_of, title_of
from cbtui.screens.windows.prediction import PredictionExit
from cbtui.widgets.code import CodeView
from cbtui.widgets.diagnosis_line import DiagnosisLine
from cbtui.widgets.lanes import Lanes
from cbtui.widgets.lanes.rows import MemberLane
from sim.diagnosis import Diagnoses, Finding
from sim.engine.commands import Pause
from sim.recording import RecordingMetadata, read
from sim.trace.events import AnyEvent, RunStarted
from sim.trace.timeline import Timeline
from tests.recording.files import write
from tests.support.builder import ns
from tests.support.console import NARROW, WIDE, RecordedConsole, settle
from tests.support.daily import first_daily
from tests.support.engine_runs import run_lesson
from tests.support.exercises import until
from tests.support.fake_session import FakeEngines
from tests.support.pictures import lines_of, text_of
from tests.support.runs import shared_group_run

TURNED = 14.5
"""Seconds: the robot has turned once, and everybody has waited for it."""


@asynccontextmanager
async def console(
    lesson: str = "shared-group", seconds: float = TURNED, size: tuple[int, int] = NARROW
) -> AsyncIterator[tuple[RecordedConsole, Pilot[None]]]:
    """A console on a real run of a lesson."""
    app = RecordedConsole(lesson, run_lesson(lesson, seconds).events, seconds)
    async with app.run_test(size=size) as pilot:
        await settle(pilot)
        yield app, pilot


async def press(pilot: Pilot[None], *keys: str) -> None:
    await pilot.press(*keys)
    await settle(pilot)


def told_of(events: Sequence[AnyEvent]) -> tuple[ExplainedFinding, ...]:
    timeline = Timeline()
    timeline.extend(events)
    watch = FindingsMonitor(timeline)
    watch.update()
    return watch.findings


def status(app: CbtuiApp) -> str:
    return lines_of(app)[0]


@pytest.mark.parametrize("size", first_daily(WIDE, NARROW), ids=["140x40", "80x24"])
async def test_the_window_tells_what_why_what_to_do_and_where(size: tuple[int, int]) -> None:
    async with console(size=size) as (app, pilot):
        await press(pilot, "d")
        shown = text_of(app)
        assert "Diagnoses: 1 problem, 4 remarks" in shown
        assert "!    4.003 s  odom_callback and scan_callback waited up to 10.5 s:" in shown
        assert "A mutually exclusive group lets one callback in at a time" in shown
        assert "→ give timer_callback a callback group of its own, and spin with" in shown
        assert size == NARROW or "node.py:94, at 4.003 s" in shown
        assert "⏎ go there" in shown
        assert "esc close" in shown
        for _ in range(12):  # a long list is scrolled
            if "·    4.000 s  timer_callback took 10.0 s with a period of 500 ms" in text_of(app):
                return
            await press(pilot, "down")
        raise AssertionError(text_of(app))


@pytest.mark.slow
@pytest.mark.parametrize("size", first_daily(WIDE, NARROW), ids=["140x40", "80x24"])
async def test_enter_goes_to_the_moment_the_lane_and_the_code(size: tuple[int, int]) -> None:
    async with console(size=size) as (app, pilot):
        await press(pilot, "d", "enter")
        assert "t 4.003 s" in status(app)
        lanes, code = app.screen.query_one(Lanes), app.screen.query_one(CodeView)
        assert lanes.selection is not None
        assert isinstance(lanes.selection.lane, MemberLane)
        assert lanes.selection.lane.entity.name == "/odom"
        assert "▸ A odom_callback is ready" in text_of(app)
        assert code.has_focus
        assert code.picked == 94
        assert "time.sleep" in text_of(app)


async def test_a_callback_that_runs_is_gone_to_there_and_not_where_its_next_call_waits() -> None:
    app = RecordedConsole("shared-group", run_lesson("shared-group", TURNED).events, 12.5)
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        lesson = app.lesson_screen
        moment = lesson.runs.timeline.moment(lesson.navigation.now)
        (running,) = moment.running.values()
        assert running.entity in moment.waiting
        lesson.selection.pick_callback(CodeView.CallbackPicked(running.entity, leaves=False))
        await settle(pilot)
        selection = app.screen.query_one(Lanes).selection
        assert selection is not None
        assert selection.bar == running


@pytest.mark.slow
@pytest.mark.parametrize("key", ["escape", "q"])
async def test_closing_leaves_everything_as_it_is(key: str) -> None:
    async with console() as (app, pilot):
        before = text_of(app)
        await press(pilot, "d", "down", key)
        assert isinstance(app.screen, LessonScreen)
        assert text_of(app) == before


@pytest.mark.slow
async def test_a_run_without_problems_says_so_and_offers_no_way() -> None:
    async with console(seconds=3.0) as (app, pilot):
        assert "problem" not in lines_of(app)[-2]
        await press(pilot, "d", "enter", "down")
        assert "No rule has found a problem so far." in text_of(app)
        assert "go there" not in text_of(app)


async def test_a_key_that_does_nothing_in_the_window_says_why_until_another_row_is_chosen(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    looked = Event()

    def judge_once_looked(_trial: CureTrial, found: ExplainedFinding, *_asked: Any) -> Verdict:
        looked.wait(30.0)
        return Verdict(found.is_problem)

    monkeypatch.setattr(CureTrial, "judge", judge_once_looked)
    async with console() as (app, pilot):
        await app.push_screen(DiagnosesScreen((), Charset.BRAILLE))
        await press(pilot, "enter")
        assert "the list is empty" in text_of(app)
        await press(pilot, "escape", "d")
        chosen = app.screen.query_one(OptionList).highlighted
        await press(pilot, "down", "t")
        assert chosen != app.screen.query_one(OptionList).highlighted
        assert "no cure of this has proved to help so far" in text_of(app)
        looked.set()
        await until(pilot, lambda: "tried, it helps" in text_of(app))  # a cure of the row before
        assert "no cure of this has proved to help so far" in text_of(app)
        await press(pilot, "up")
        assert "has proved" not in text_of(app)
        for key in ("down", "t"):  # faster than the list tells of the row that it has gone to
            app.post_message(Key(key, key if len(key) == 1 else None))
        await settle(pilot)
        assert "no cure of this has proved to help so far" in text_of(app)


@pytest.mark.slow
async def test_what_is_true_of_the_whole_run_offers_no_way_to_go() -> None:
    async with console("split-groups", 3.0) as (app, pilot):
        await press(pilot, "d")
        assert "Diagnoses: 1 remark" in text_of(app)
        assert "go there" not in text_of(app)
        await press(pilot, "enter")
        assert isinstance(app.screen, DiagnosesScreen)


@pytest.mark.slow
async def test_a_click_on_the_line_opens_the_list_and_one_in_the_list_highlights() -> None:
    async with console() as (app, pilot):
        await pilot.click(DiagnosisLine)
        await settle(pilot)
        assert isinstance(app.screen, DiagnosesScreen)
        row = next(
            place for place, line in enumerate(lines_of(app)) if "4.003 s  odom_callback and scan" in line
        )
        await pilot.click(offset=(20, row))
        await settle(pilot)
        assert "→ give timer_callback a callback group of its own" in text_of(app)


async def test_of_a_past_moment_the_line_counts_later_problems_and_tells_of_none() -> None:
    async with console() as (app, pilot):
        assert "1 problem · d" in lines_of(app)[-2]
        await press(pilot, *["left_square_bracket"] * 12)
        assert "t 2.5" in status(app)
        assert lines_of(app)[-2].startswith(" ✓ nothing waits")
        assert "1 problem · d" in lines_of(app)[-2]


@pytest.mark.slow
async def test_another_run_begins_without_findings() -> None:
    async with console() as (app, pilot):
        app.engines._events = []
        await press(pilot, "t", "2")
        assert "problem" not in text_of(app)


@pytest.mark.slow
async def test_the_rules_look_at_most_twice_a_second_whatever_is_drawn(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    looks = 0
    update = Diagnoses.update

    def counting(self: Diagnoses, timeline: Timeline) -> tuple[Finding, ...]:
        nonlocal looks
        looks += 1
        return update(self, timeline)

    async with console() as (app, pilot):
        monkeypatch.setattr(Diagnoses, "update", counting)
        began = monotonic()
        for _ in range(50):
            app.lesson_screen.draw()
            app.lesson_screen._frames._draw_if_due()
        await pilot.pause()
        assert looks <= 2 * (monotonic() - began) + 1


@asynccontextmanager
async def recording(events: Sequence[AnyEvent], folder: Path) -> AsyncIterator[tuple[CbtuiApp, Pilot[None]]]:
    """A recording of a run of shared-group on screen, read to its end."""
    path = folder / "run.mcap"
    write(path, events, RecordingMetadata(title="shared-group", clock="virtual"))
    app = CbtuiApp(start_recording=read(path))
    app.animation_level = "none"
    async with app.run_test(size=WIDE) as pilot:
        await settle(pilot)
        screen = app.screen
        assert isinstance(screen, ReplayScreen)
        while not screen.runs.run.is_read:
            await pilot.pause(0.01)
        await settle(pilot)
        yield app, pilot


@pytest.mark.slow
async def test_a_recording_has_its_diagnoses_too(tmp_path: Path) -> None:
    async with recording(run_lesson("shared-group", TURNED).events, tmp_path) as (app, pilot):
        assert "1 problem · d" in lines_of(app)[-2]
        await press(pilot, "d", "enter")
        assert "t 4.003 s" in status(app)
        assert "▸ A odom_callback is ready" in text_of(app)
        assert app.screen.query_one(CodeView).picked == 94


@pytest.mark.slow
async def test_what_was_found_before_a_recording_begins_is_said_to_be(tmp_path: Path) -> None:
    begun = [
        structs.replace(each, known_from=ns(6.0)) if isinstance(each, RunStarted) else each
        for each in run_lesson("shared-group", TURNED).events
    ]
    async with recording(begun, tmp_path) as (app, pilot):
        await press(pilot, "d", "enter")
        assert "t 6.000 s" in status(app)
        said = [notification.message for notification in app._notifications]
        assert said == ["4.003 s is before this recording begins, at 6.000 s"]


def test_a_finding_is_a_line_and_a_paragraph() -> None:
    worst = told_of(shared_group_run().until(TURNED))[0]
    what = "odom_callback and scan_callback waited up to 10.5 s: group A was held by timer_callback"
    assert row_of(worst, Charset.BRAILLE).plain == f"!    4.003 s  {what}"
    assert details_of(worst, Charset.BRAILLE).plain.splitlines() == [
        f"{worst.explanation.what}.",
        "A mutually exclusive group lets one callback in at a time, however many threads are free.",
        "→ give timer_callback a callback group of its own, and spin with "
        "MultiThreadedExecutor(num_threads=2); or let timer_callback return sooner.",
        "node.py:120, at 4.003 s",
    ]


def test_a_finding_that_ends_in_a_question_gets_no_full_stop() -> None:
    worst = told_of(shared_group_run().until(TURNED))[0]
    asked = replace(worst, explanation=replace(worst.explanation, what="is it 'spin'?", cure="or 'run'?"))
    lines = details_of(asked, Charset.BRAILLE).plain.splitlines()
    assert (lines[0], lines[2]) == ("is it 'spin'?", "→ or 'run'?")
    assert "is it 'spin'? why: " in told_finding(asked)
    assert "or 'run'? node.py:120" in told_finding(asked)


def test_the_title_counts_what_there_is() -> None:
    told = told_of(shared_group_run().until(TURNED))
    remarks = [each for each in told if not each.is_problem]
    assert title_of(told[:1]) == "Diagnoses: 1 problem"
    assert title_of([*told[:1] * 2, *remarks[:1]]) == "Diagnoses: 2 problems, 1 remark"
    assert title_of([]) == "Diagnoses"


def test_the_note_names_the_key_in_force() -> None:
    told = told_of(shared_group_run().until(TURNED))[:1]
    assert problems_note(told, STANDARD, Charset.BRAILLE) == "1 problem · d"
    assert problems_note(told, Keymap({"lesson.diagnoses": ("D",)}), Charset.ASCII).endswith(" D")
    assert problems_note([], STANDARD, Charset.BRAILLE) == ""


def test_moments_of_findings_lie_in_the_run() -> None:
    told = told_of(run_lesson("shared-group", TURNED).events)
    assert all(each.at is not None and 0 < each.at <= ns(TURNED) for each in told)


def test_what_is_stuck_from_the_very_beginning_of_a_run_has_its_moment_in_the_list() -> None:
    worst = told_of(shared_group_run().until(TURNED))[0]
    at_once = replace(worst, finding=replace(worst.finding, at=0, stuck=frozenset([1])))
    assert at_once.at == 0
    assert "0.000 s" in row_of(at_once, Charset.BRAILLE).plain


async def test_the_window_has_its_text_from_the_first_moment_on_and_no_two_rows_are_empty() -> None:
    findings = told_of(shared_group_run().until(TURNED))
    app = CbtuiApp()
    async with app.run_test(size=NARROW) as pilot:
        window = DiagnosesScreen(findings, Charset.BRAILLE)
        await app.push_screen(window)
        told = str(window.query_one(".told", Static).content)
        assert findings[0].explanation.what in told
        await settle(pilot)
        inside = [line.strip("│ ") for line in lines_of(app) if line.startswith("│")]
        assert not any(above == below == "" for above, below in pairwise(inside))


async def test_what_there_is_to_say_is_whole_as_the_window_opens() -> None:
    async with console() as (app, pilot):
        await app.push_screen(DiagnosesScreen(told_of(shared_group_run().until(TURNED)), Charset.BRAILLE))
        await settle(pilot)
        told = app.screen.query_one(".told")
        assert told.size.height > 3
        assert not app.screen.query_one(".well").display
        assert "A mutually exclusive group lets one callback in at a time" in text_of(app)


async def test_a_problem_that_comes_while_the_window_is_open_is_listed() -> None:
    async with console() as (app, pilot):
        found = told_of(shared_group_run().until(TURNED))
        latest: list[ExplainedFinding] = []
        beside = "nothing has come on /odom"
        screen = DiagnosesScreen((), Charset.BRAILLE, latest=lambda: tuple(latest), beside=lambda: beside)
        await app.push_screen(screen)
        await settle(pilot)
        assert "No rule has found a problem so far" in text_of(app)
        assert "Nothing has come on /odom." in text_of(app)
        latest.extend(found)
        await until(pilot, lambda: title_of(found) in text_of(app))
        await until(
            pilot, lambda: "A mutually exclusive group lets one callback in at a time" in text_of(app)
        )
        assert "No rule has found" not in text_of(app)
        assert "Nothing has come on /odom." in text_of(app)


async def test_what_the_window_tells_follows_the_run_and_nothing_moves() -> None:
    latest = [told_of(shared_group_run().until(9.0))]
    place = next(
        place for place, each in enumerate(latest[0]) if "odom_callback lost" in each.explanation.what
    )
    async with console() as (app, pilot):
        now = [ns(9.0)]
        screen = DiagnosesScreen(latest[0], Charset.BRAILLE, latest=lambda: latest[0], as_of=lambda: now[0])
        await app.push_screen(screen)
        await settle(pilot)
        assert ", as of 9.0 s " in text_of(app)
        await press(pilot, *["down"] * place)
        assert "waited up to 5.0 s" in text_of(app)
        assert text_of(app).count("odom_callback lost 90 messages") == 2  # in the list and below it
        latest[0], now[0] = told_of(shared_group_run().until(12.0)), ns(12.0)
        await until(pilot, lambda: ", as of 12.0 s " in text_of(app))
        await until(pilot, lambda: "waited up to 8.0 s" in text_of(app))
        assert text_of(app).count("odom_callback lost 150 messages") == 2
        assert screen.query_one(OptionList).highlighted == place


async def test_the_window_closes_when_another_run_begins_as_of_a_saved_file() -> None:
    async with console() as (app, pilot):
        lesson = app.screen
        assert isinstance(lesson, LessonScreen)
        await press(pilot, "d")
        assert isinstance(app.screen, DiagnosesScreen)
        lesson.runs.begin(None)
        await until(pilot, lambda: app.screen is lesson)


@pytest.mark.slow
async def test_enter_opens_the_lesson_that_shows_a_problem_and_q_comes_back(tmp_path: Path) -> None:
    file = tmp_path / "mine.py"
    file.write_text("")
    engines = FakeEngines(shared_group_run().until(TURNED), ns(TURNED))
    app = CbtuiApp(start_file=(file, [], "real"), open_session=engines)
    async with app.run_test(size=WIDE) as pilot:
        await settle(pilot)
        await press(pilot, "d")
        assert "→ open lesson 1, which shows this" in text_of(app)
        await press(pilot, "down", "enter")
        assert "Single thread" in text_of(app)
        assert engines.sessions[0].commands == [Pause()]
        app.screen.dismiss(PredictionExit.ON)
        await settle(pilot)
        assert "q back" in text_of(app)
        assert len(engines.sessions) == 2
        await press(pilot, "q")
        assert "mine.py" in text_of(app).splitlines()[0]
        assert "q menu" in text_of(app)
        assert not engines.sessions[0].stopped


@pytest.mark.parametrize("size", [WIDE, NARROW], ids=["140x40", "80x24"])
async def test_rows_keep_their_ellipsis_and_the_width_they_need(size: tuple[int, int]) -> None:
    events = run_lesson("shared-group", TURNED).events
    [first, *_] = told_of(events)
    long = replace(first, explanation=replace(first.explanation, what=" ".join(["a_long_name"] * 10)))
    app = RecordedConsole("shared-group", events, TURNED)
    async with app.run_test(size=size) as pilot:
        window = DiagnosesScreen([long] * 5, Charset.BRAILLE)
        app.push_screen(window)
        await settle(pilot)
        listed = window.query_one(OptionList)
        wide = listed.scrollable_content_region.width
        window._findings = [long] * 9
        window._list([long] * 9)
        window._show_options()
        await settle(pilot)
        assert listed.scrollable_content_region.width == wide
        rows = [line for line in lines_of(app) if "a_long_name a_long_name" in line and "4.003 s" in line]
        assert rows
        assert all("…" in row or row.count("a_long_name") == 10 for row in rows)
        if size == WIDE:
            assert window.query_one(".window").size.width > 120
