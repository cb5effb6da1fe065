import asyncio
import re
import threading
import time
from collections import Counter
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import pytest
from textual.pilot import Pilot
from textual.screen import Screen
from textual.widget import Widget
from textual.widgets import Static

from cbtui.keys.action import Scope, method_of
from cbtui.keys.actions import ACTIONS
from cbtui.keys.signs import character_of
from cbtui.looks.theme import GLYPHS, Charset
from cbtui.runs.live.live_run import RunState
from cbtui.screens.lesson import LessonScreen
from cbtui.screens.menu import MenuScreen
from cbtui.screens.parts.frames import FrameContent, FrameLoop
from cbtui.screens.windows.help import HelpScreen
from cbtui.screens.windows.prediction import PredictionScreen
from cbtui.screens.windows.threads import ThreadsScreen
from cbtui.terminal import textual_internals
from cbtui.widgets.code import CodeView
from cbtui.widgets.factory import FactoryView
from cbtui.widgets.guide import Guide
from cbtui.widgets.lanes import Lanes
from cbtui.widgets.log import LogView
from cbtui.widgets.log.lines import LogLines
from cbtui.widgets.robot import RobotView
from cbtui.widgets.shell import ShellOutput, ShellView
from lessons.catalogue import lessons
from sim.engine.commands import CallService, Pause, ResetWorld, Resume, SetSpeed
from tests.support.builder import ns
from tests.support.console import NARROW, WIDE, RecordedConsole, predict, settle
from tests.support.daily import first_daily, first_row_daily
from tests.support.exercises import until
from tests.support.fake_session import FakeSession
from tests.support.pictures import lines_of, text_of
from tests.support.runs import dummy_server_run, shared_group_run

EVENTS = shared_group_run().events
SHOWN = (Scope.LESSON, Scope.PROMPT, Scope.COMPARE, Scope.MENU, Scope.EVERYWHERE)
PANES: dict[str, type[Widget]] = {
    "1": Guide,
    "2": CodeView,
    "3": FactoryView,
    "4": RobotView,
    "5": LogView,
    "6": ShellView,
}


@asynccontextmanager
async def console(
    size: tuple[int, int] = NARROW, lesson: str = "shared-group"
) -> AsyncIterator[tuple[RecordedConsole, Pilot[None]]]:
    """A console on the lesson, 13.15 s into its run."""
    app = RecordedConsole(lesson, EVENTS, 13.15)
    async with app.run_test(size=size) as pilot:
        await settle(pilot)
        yield app, pilot


async def press(pilot: Pilot[None], *keys: str) -> None:
    await pilot.press(*keys)
    await settle(pilot)


def on_top(app: RecordedConsole) -> type[object]:
    """What kind of screen takes the keys."""
    return type(app.screen)


def status(app: RecordedConsole) -> str:
    return lines_of(app)[0]


def diagnosis(app: RecordedConsole) -> str:
    return lines_of(app)[-2]


@pytest.mark.slow
async def test_a_run_that_other_terminals_do_not_reach_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(FakeSession, "start", lambda _session: "lines do not reach this run")
    async with console() as (app, _):
        assert "lines do not reach this run" in [each.message for each in app._notifications]


@pytest.mark.parametrize("key", ["d", "question_mark"])
async def test_no_sentence_lies_over_a_window_that_is_opened(key: str) -> None:
    async with console() as (app, pilot):
        lesson = app.lesson_screen
        lesson.tell("The guide now tells what happened.")
        await pilot.pause()
        assert len(app._notifications) == 1
        await press(pilot, key)
        assert app.screen is not lesson
        assert not app._notifications


async def test_who_types_on_has_no_sentence_in_the_way_that_was_read(monkeypatch: pytest.MonkeyPatch) -> None:
    async with console() as (app, pilot):
        app.notify("just said")
        await press(pilot, "tab")
        assert app._notifications, "nobody has read it yet"
        app.notify("take care", severity="warning")
        app.notify("a hint", timeout=15)
        monkeypatch.setattr(textual_internals, "time", lambda: time.time() + 1.1)
        await press(pilot, "tab")
        assert [each.message for each in app._notifications] == ["take care", "a hint"]


async def test_keys_reach_the_engine_as_commands() -> None:
    async with console() as (app, pilot):
        await press(pilot, "s", "S", "r", "plus", "minus", "minus", "space")
        assert app.engines.latest.commands == [
            CallService("/motor_power", True),
            CallService("/motor_power", False),
            ResetWorld(),
            SetSpeed(2.0),
            SetSpeed(1.0),
            SetSpeed(0.5),
            Pause(),
        ]


async def test_s_calls_the_service_of_the_lesson() -> None:
    app = RecordedConsole("reentrant-2-threads", dummy_server_run().events, 2.0)
    async with app.run_test(size=NARROW) as pilot:
        await press(pilot, "s")
        assert app.engines.latest.commands == [CallService("/dummy_server_srv", True)]


async def test_space_goes_on_after_a_pause() -> None:
    async with console() as (app, pilot):
        await press(pilot, "space")
        assert "‖ PAUSED" in status(app)
        assert "space" in text_of(app) or "␣ go on" in text_of(app)
        await press(pilot, "r")
        [told] = [each.message for each in app._notifications]
        assert told == "The robot is back at its start when the run goes on: ␣."
        await press(pilot, "space")
        assert "● LIVE" in status(app)
        assert app.engines.latest.commands == [Pause(), ResetWorld(), Resume()]


async def test_a_call_in_a_run_that_stands_still_is_said_to_come_later() -> None:
    async with console() as (app, pilot):
        await press(pilot, "space", "s")
        [told] = [each.message for each in app._notifications]
        assert told == "The service is called when the run goes on: ␣."


async def test_a_letter_that_is_no_key_says_that_it_does_nothing() -> None:
    async with console() as (app, pilot):
        await press(pilot, "b")
        await press(pilot, "9")
        [told] = [each.message for each in app._notifications]
        assert told == "9 does nothing here; ? lists the keys."
        await press(pilot, "colon", "b")
        assert [each.message for each in app._notifications] == [told]


@pytest.mark.slow
async def test_speed_is_shown_and_ends_where_it_cannot_be_changed_further() -> None:
    async with console() as (app, pilot):
        await press(pilot, *["plus"] * 7)
        assert "● LIVE  max " in status(app)
        assert len(app.engines.latest.commands) == 5


@pytest.mark.slow
async def test_r_runs_again_after_the_engine_was_lost() -> None:
    async with console() as (app, pilot):
        app.engines.latest.end("the engine was killed by signal 9")
        await settle(pilot)
        assert "✗ LOST" in status(app)
        assert "engine lost: killed by signal 9; r runs again" in text_of(app)
        await press(pilot, "r")
        assert len(app.engines.sessions) == 2
        assert app.engines.sessions[0].stopped
        assert "● LIVE" in status(app)


@pytest.mark.slow
async def test_r_runs_again_after_the_run_has_ended() -> None:
    async with console() as (app, pilot):
        app.engines.latest.play(ns(100))
        app.engines.latest.end(None)
        await settle(pilot)
        assert "■ ENDED" in status(app)
        await press(pilot, "comma")
        assert "0 end" in lines_of(app)[-1], "what is over has no present to go back to"
        await press(pilot, "r")
        assert "● LIVE" in status(app)
        assert "t 13.1" in status(app)


async def test_of_two_restarts_at_once_only_the_last_run_starts(monkeypatch: pytest.MonkeyPatch) -> None:
    async with console() as (app, pilot):
        may_stop, begun = threading.Event(), list[FakeSession]()
        monkeypatch.setattr(FakeSession, "stop", lambda session: session.started and may_stop.wait(30))

        def start(session: FakeSession) -> None:
            begun.append(session)

        monkeypatch.setattr(FakeSession, "start", start)
        screen = app.screen
        assert isinstance(screen, LessonScreen)
        both = asyncio.gather(*(screen.restarts.again(screen.changes) for _ in range(2)))
        await settle(pilot)
        may_stop.set()
        await both
        assert begun == [app.engines.latest]
        assert len(app.engines.sessions) == 3


@pytest.mark.slow
async def test_what_an_engine_sends_after_its_run_was_replaced_does_not_count() -> None:
    async with console() as (app, pilot):
        await press(pilot, "t", "2")
        old, new = app.engines.sessions
        old.play(ns(100))
        old.end("the engine was killed by signal 9")
        await settle(pilot)
        assert app.lesson_screen.runs.run.state is RunState.LIVE
        assert app.lesson_screen.runs.run.timeline.end == ns(13.15)
        assert not new.stopped


@pytest.mark.parametrize(("key", "threads"), first_row_daily(("8", 8), ("1", 1), ("o", None)))
async def test_t_runs_again_with_other_threads(key: str, threads: int | None) -> None:
    async with console() as (app, pilot):
        await press(pilot, "t")
        assert on_top(app) is ThreadsScreen
        await press(pilot, key)
        assert on_top(app) is LessonScreen
        assert [session.stopped for session in app.engines.sessions] == [True, False]
        assert app.engines.latest.started
        assert app.engines.latest.setup.threads == threads


@pytest.mark.slow
async def test_the_chosen_threads_stay_for_the_next_run() -> None:
    async with console() as (app, pilot):
        await press(pilot, "t", "3")
        app.engines.latest.end("gone")
        await settle(pilot)
        await press(pilot, "r")
        assert app.engines.latest.setup.threads == 3
        await press(pilot, "t", "enter")
        assert app.engines.latest.setup.threads == 3


@pytest.mark.slow
async def test_thinking_better_of_the_threads_leaves_the_run_alone() -> None:
    async with console() as (app, pilot):
        for key in ("escape", "q"):
            await press(pilot, "t", key)
            assert isinstance(app.screen, LessonScreen)
            assert len(app.engines.sessions) == 1


@pytest.mark.slow
async def test_n_opens_the_next_lesson_and_ends_this_run() -> None:
    async with console() as (app, pilot):
        predict(app, lessons()[2].id)
        await press(pilot, "n")
        assert app.lesson_screen.subject.lesson == lessons()[2]
        await until(pilot, lambda: app.engines.sessions[0].stopped)
        assert not app.engines.latest.stopped


async def test_the_next_lesson_takes_keys_while_the_engine_of_the_one_before_ends(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    may_end = threading.Event()
    async with console() as (app, pilot):
        engine = app.engines.latest
        stop = engine.stop

        def stop_slowly() -> None:
            may_end.wait()
            stop()

        monkeypatch.setattr(engine, "stop", stop_slowly)
        await press(pilot, "n")
        assert isinstance(app.screen, PredictionScreen)
        await press(pilot, "q")
        assert isinstance(app.screen, MenuScreen)
        assert not engine.stopped
        threading.Timer(0.1, may_end.set).start()
    assert engine.stopped


@pytest.mark.slow
async def test_the_last_lesson_has_no_next_one() -> None:
    async with console(size=WIDE, lesson=lessons()[-1].id) as (app, pilot):
        assert "n next" not in lines_of(app)[-1]
        await press(pilot, "n")
        assert app.lesson_screen.subject.lesson == lessons()[-1]


async def test_q_ends_the_run_and_goes_back_to_the_menu() -> None:
    async with console() as (app, pilot):
        engine = app.engines.latest
        await press(pilot, "q")
        assert isinstance(app.screen, MenuScreen)
        await until(pilot, lambda: engine.stopped)


@pytest.mark.slow
async def test_leaving_the_console_ends_the_run() -> None:
    async with console() as (app, pilot):
        await pilot.press("ctrl+q")
    assert app.engines.latest.stopped


@pytest.mark.slow
async def test_the_help_lists_every_key() -> None:
    async with console(size=(110, 400)) as (app, pilot):
        await press(pilot, "question_mark")
        text = text_of(app)
        missing = {
            action.line
            for action in ACTIONS
            if action.scope in SHOWN and action.label and action.line not in text
        }
        assert not missing


@pytest.mark.slow
async def test_the_help_closes_again() -> None:
    async with console() as (app, pilot):
        for key in ("question_mark", "escape", "q"):
            await press(pilot, "question_mark")
            assert on_top(app) is HelpScreen
            await press(pilot, key)
            assert isinstance(app.screen, LessonScreen)
        assert not app.engines.latest.stopped


@pytest.mark.parametrize(
    ("keys", "first"),
    first_row_daily((("n",), "Prediction"), (("d",), "Diagnoses"), (("t",), "Choice of threads")),
)
async def test_the_help_over_a_window_begins_with_the_keys_of_that(keys: tuple[str, ...], first: str) -> None:
    async with console() as (app, pilot):
        await press(pilot, *keys)
        window = app.screen
        await press(pilot, "question_mark")
        assert isinstance(app.screen, HelpScreen)
        assert str(app.screen.query_one("#found", Static).render()).startswith(first)
        await press(pilot, "escape")
        assert app.screen is window


@pytest.mark.slow
async def test_the_help_begins_with_the_signs_and_finds_words() -> None:
    async with console() as (app, pilot):
        await press(pilot, "question_mark")
        assert "another one holds its group" in text_of(app)
        assert f" {GLYPHS[Charset.BRAILLE].textures}  the fills of long bars" in text_of(app)
        assert " · ────  a callback holds its group, for a moment or for long; or runs" in text_of(app)
        assert " ▲ ◂  a service is called and replies; your own call has its key" in text_of(app)
        await press(pilot, "slash", *"record")
        assert "Start or stop recording the run" in text_of(app)
        assert "another one holds its group" not in text_of(app)
        await press(pilot, *["backspace"] * 6, *"zoom")
        assert "Show a longer stretch of time" in text_of(app), "by the word that the footer has for it"
        await press(pilot, "escape")
        assert "another one holds its group" in text_of(app), "the search is over, not the help"
        await press(pilot, "escape")
        assert isinstance(app.screen, LessonScreen)


async def test_the_help_says_in_its_foot_how_to_scroll_and_what_is_below() -> None:
    async with console() as (app, pilot):
        await press(pilot, "question_mark")
        foot = " ".join(lines_of(app)[-2:])
        for text in ("scroll", "tab next heading", "/ search", "esc close", "below: Learn, Act on the run"):
            assert text in foot
        await press(pilot, "tab")
        assert "Learn" in lines_of(app)[1]
        assert "below: Time" in lines_of(app)[-1]
        await press(pilot, "down")
        assert "Say what you expect of the run" in lines_of(app)[1]


async def test_a_wide_help_has_the_keys_by_task_beside_the_signs() -> None:
    async with console(WIDE) as (app, pilot):
        await press(pilot, "question_mark")
        assert lines_of(app)[1].split() == ["│", "Signs", "of", "the", "lanes", "Learn", "│"]
        for text in ("the moment on screen", "Act on the run", "Pause: stop time for every thread"):
            assert text in text_of(app)
        await press(pilot, "slash", *"zoom")
        assert "Show a longer stretch of time" in text_of(app)
        assert "Learn" not in text_of(app)


async def test_the_frame_of_the_lanes_names_no_key_of_another_pane() -> None:
    async with console(WIDE) as (app, pilot):
        lanes = app.lesson_screen.query_one(Lanes)
        assert "copy" in lanes.hint
        await press(pilot, "5")
        assert "zoom" in lanes.hint
        assert "copy" not in lanes.hint, "y copies lines of the log now"


async def test_a_window_leaves_the_lanes_in_sight() -> None:
    async with console() as (app, pilot):
        for key in ("t", "p", "x", "G", "k"):
            lanes = app.lesson_screen.query_one(Lanes).region
            await press(pilot, key)
            assert app.screen.query_one(".window").region.y >= lanes.bottom, key
            await press(pilot, "escape")


async def test_a_key_that_does_nothing_here_says_why() -> None:
    async with console() as (app, pilot):
        await press(pilot, "e", "e", "C")
        told = [note.message for note in app._notifications]
        assert told[0] == "One shared group has no exercise: it is done once it is predicted and explained."
        assert told[1].startswith("There is only one run so far"), "a repeated sentence is shown once"
        assert "e exercise" not in text_of(app)


async def test_what_is_said_again_is_shown_once_and_begins_its_time_anew() -> None:
    app = RecordedConsole("shared-group", EVENTS, 13.15)
    async with app.run_test(size=NARROW, notifications=True) as pilot:
        await settle(pilot)
        await press(pilot, "e")
        await until(pilot, lambda: len(app.screen.query("Toast")) == 1)
        before = app.screen.query("Toast").first()
        await press(pilot, "e")
        await until(pilot, lambda: [before] != list(app.screen.query("Toast")) != [])
        assert len(app.screen.query("Toast")) == len(app._notifications) == 1


async def test_what_keys_say_covers_no_more_than_two_sentences_and_takes_no_warning_away() -> None:
    async with console() as (app, pilot):
        app.notify("the disk is full", severity="warning")
        await press(pilot, *"eCuiw")
        told = [note.message for note in app._notifications]
        assert told[0] == "the disk is full"
        assert told[1:] == [
            "There is only one run so far: change something with t, g or p first.",
            "Only an exercise is watched again.",
        ]


@pytest.mark.parametrize("moment", [0.0, 13.15])
async def test_each_sign_of_the_help_does_something_at_any_moment_or_says_why_not(moment: float) -> None:
    app = RecordedConsole("shared-group", EVENTS, moment)
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        of_lesson = [action for action in ACTIONS if action.scope is Scope.LESSON]
        answered = {each.key for each in of_lesson if app.screen.check_action(*method_of(each))}
        assert {each.key for each in of_lesson if character_of(each.key)} - answered == {"7"}


async def test_the_help_has_what_does_nothing_now_in_brackets_and_each_key_once_for_a_task() -> None:
    async with console(WIDE) as (app, pilot):
        await press(pilot, "question_mark")
        assert "in brackets: not now" in lines_of(app)[0]
        text = text_of(app)
        assert " (e)  Do the exercise in your own file; there, back to" in text
        assert "  a  Explain what happened" in text
        learn = re.findall(r"  (\S+)  [A-Z]", text.partition("Learn")[2].partition("Act on the run")[0])
        assert all(count == 1 for count in Counter(learn).values())
        await press(pilot, "escape", "a", "question_mark")
        assert "  a  Explain what happened" in text_of(app)


async def test_a_narrow_screen_shows_the_pane_of_a_number() -> None:
    async with console() as (app, pilot):
        panes = [app.screen.query_one(pane) for pane in PANES.values()]
        for key, shown in zip(PANES, panes, strict=True):
            await press(pilot, key)
            assert [pane for pane in panes if pane.display] == [shown]
            assert shown.has_focus_within


@pytest.mark.slow
async def test_tab_goes_round_the_panes() -> None:
    async with console() as (app, pilot):
        for pane in (CodeView, FactoryView, RobotView, LogLines, ShellOutput, Guide):
            await press(pilot, "tab")
            assert app.screen.query_one(pane).has_focus


@pytest.mark.slow
async def test_a_click_on_a_name_shows_its_pane() -> None:
    async with console() as (app, pilot):
        line = next(y for y, text in enumerate(lines_of(app)) if "4 Robot" in text)
        await pilot.click(offset=(lines_of(app)[line].index("4 Robot"), line))
        await settle(pilot)
        assert app.screen.query_one(RobotView).display


async def test_a_wide_screen_shows_every_pane_but_the_shell_which_takes_the_place_of_the_log() -> None:
    async with console(size=WIDE) as (app, pilot):
        shell, log = app.screen.query_one(ShellView), app.screen.query_one(LogView)
        others = [app.screen.query_one(pane) for pane in PANES.values() if pane not in {ShellView, LogView}]
        assert all(pane.display for pane in others)
        assert (log.display, shell.display) == (True, False)
        await press(pilot, "colon")
        assert all(pane.display for pane in others)
        assert (log.display, shell.display) == (False, True)
        await press(pilot, "escape", "5")
        assert (log.display, shell.display) == (True, False)


@pytest.mark.slow
@pytest.mark.parametrize("size", first_daily(WIDE, NARROW))
async def test_z_gives_the_screen_to_one_pane_and_back(size: tuple[int, int]) -> None:
    async with console(size) as (app, pilot):
        await press(pilot, "5", "z")
        log = app.screen.query_one(LogView)
        assert log.outer_size == (size[0], size[1] - (3 if size == WIDE else 4))
        assert not app.screen.query_one(Lanes).display
        await press(pilot, "z")
        assert app.screen.query_one(Lanes).display


async def test_brackets_look_back_in_time_on_every_pane_at_once() -> None:
    async with console(WIDE) as (app, pilot):
        assert "SLEEPING==9" in text_of(app)
        await press(pilot, *["left_square_bracket"] * 10)
        assert "◂ BACK 10.0 s" in status(app)
        assert "t 3.150 s" in status(app)
        assert "SLEEPING" not in text_of(app)
        assert "nothing waits" in diagnosis(app), "what comes at 4 s is not told yet"
        await press(pilot, "right_square_bracket")
        assert "t 4.150 s" in status(app)
        assert "waits 147 ms: group A is held by timer_callback" in diagnosis(app)
        await press(pilot, "0")
        assert "● LIVE" in status(app)


@pytest.mark.slow
async def test_looking_back_stands_still_while_the_run_goes_on() -> None:
    async with console(WIDE) as (app, pilot):
        await press(pilot, "left_square_bracket")
        app.engines.latest.play(ns(20.0))
        await settle(pilot)
        assert "t 12.150 s" in status(app)
        assert "◂ BACK 7.8 s" in status(app)


async def test_zooming_changes_the_stretch_of_time() -> None:
    async with console() as (app, pilot):
        lanes = app.screen.query_one(Lanes)
        assert lanes.window.length == ns(10)
        await press(pilot, "greater_than_sign")
        assert lanes.window.length == ns(5)
        await press(pilot, "less_than_sign", "less_than_sign")
        assert lanes.window.length == ns(20)


@pytest.mark.slow
async def test_keys_that_mean_nothing_now_are_not_offered() -> None:
    async with console(WIDE) as (app, pilot):
        assert "0 live" not in lines_of(app)[-1]
        await press(pilot, "left_square_bracket")
        assert "0 live" in lines_of(app)[-1]
        app.engines.latest.end("gone")
        await settle(pilot)
        assert "service" not in lines_of(app)[-1]
        assert "r run again" in lines_of(app)[-1]


async def test_esc_takes_away_what_is_told_over_the_screen() -> None:
    async with console() as (app, pilot):
        await press(pilot, "C")
        assert len(app._notifications) == 1
        await press(pilot, "escape")
        assert not app._notifications
        assert isinstance(app.screen, LessonScreen)


async def test_texts_that_are_drawn_later_show_the_moment_of_the_other_panes(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    async with console(WIDE) as (app, _pilot):
        shown: list[int] = []
        monkeypatch.setattr(CodeView, "show", lambda _view, _timeline, now: shown.append(now))
        screen = app.lesson_screen
        screen.query_one(Lanes).told = ns(12.0)
        screen._frames.draw(FrameContent.TEXTS)
        assert shown == [ns(12.0)]


async def test_nothing_is_drawn_while_nothing_happens(monkeypatch: pytest.MonkeyPatch) -> None:
    async with console() as (app, pilot):
        await press(pilot, "space")
        drawn: list[FrameContent] = []

        def draw(_: FrameLoop, content: FrameContent) -> None:
            drawn.append(content)

        monkeypatch.setattr(FrameLoop, "draw", draw)
        await pilot.pause(0.2)
        assert drawn == []
        app.push_screen(Screen[None]())
        app.engines.latest.play(ns(13.9))
        await pilot.pause(0.2)
        assert drawn == [], "it is covered"
        app.pop_screen()
        app.engines.latest.play(ns(14.0))
        app.engines.latest.play(ns(14.1))
        while not drawn:
            await pilot.pause(0.02)
