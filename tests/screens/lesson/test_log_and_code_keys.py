"""The log and the code on the whole screen: their keys, and the ways between them and the lanes."""

import asyncio
import sys
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import replace
from pathlib import Path

import pytest
from textual.events import Key
from textual.pilot import Pilot
from textual.widgets import Input

from cbtui.app import CbtuiApp
from cbtui.keys.action import PANES
from cbtui.runs.setup.shown_program import of_file
from cbtui.screens.parts import panes
from cbtui.screens.parts.runs import RunController
from cbtui.terminal import key_turns
from cbtui.widgets.code import CodeView
from cbtui.widgets.diagnosis import Diagnosis, DiagnosisLevel
from cbtui.widgets.diagnosis_line import DiagnosisLine
from cbtui.widgets.lanes import Lanes
from cbtui.widgets.log import LogFilter
from cbtui.widgets.shell import Prompt
from sim.diagnosis import CodeLocation
from tests.support.builder import ns
from tests.support.console import NARROW, WIDE, RecordedConsole, settle
from tests.support.exercises import until
from tests.support.fake_session import FakeEngines
from tests.support.pictures import lines_of, text_of
from tests.support.runs import shared_group_run

EVENTS = shared_group_run().events
LATER = [event for event in EVENTS if ns(13.15) < event.t <= ns(14.0)]
LOG, CODE = (str(PANES.index(pane) + 1) for pane in ("log", "code"))


@asynccontextmanager
async def console(size: tuple[int, int] = NARROW) -> AsyncIterator[tuple[RecordedConsole, Pilot[None]]]:
    """A console on "One shared group", 13.15 s into its run."""
    app = RecordedConsole("shared-group", EVENTS, 13.15)
    async with app.run_test(size=size, notifications=True) as pilot:
        await settle(pilot)
        yield app, pilot


async def press(pilot: Pilot[None], *keys: str) -> None:
    await pilot.press(*keys)
    await settle(pilot)


def tabs(app: RecordedConsole) -> str:
    return next(line for line in lines_of(app) if "1 Guide" in line)


async def test_the_keys_tell_at_once_whether_the_log_is_followed() -> None:
    async with console() as (app, pilot):
        await press(pilot, LOG)
        for before, after in (("f stay", "f follow"), ("f follow", "f stay")):
            assert before in lines_of(app)[-1]
            await pilot.press("f")
            await until(pilot, lambda: after in lines_of(app)[-1])  # noqa: B023 it is of this turn


@pytest.mark.parametrize(("key", "line"), [("slash", LogFilter), ("colon", Prompt)])
async def test_what_is_typed_in_one_go_goes_where_its_first_key_leads(
    key: str, line: type[Input], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(key_turns, "PATIENCE", 10.0)  # a busy machine is slow, too
    async with console() as (app, pilot):
        for pane in ("2", "5"):
            await press(pilot, pane)
            assert not app.screen.query_one(line).has_focus
            for each in (key, *"timer"):  # r alone would reset the world
                app.post_message(Key(each, None if each == key else each))
            await until(pilot, lambda: app.screen.query_one(line).value == "timer")
            assert app.screen.query_one(line).has_focus
            app.screen.query_one(line).value = ""
            await press(pilot, "escape")


async def test_escape_and_a_letter_that_come_at_once_are_no_letter_with_alt(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(key_turns, "PATIENCE", 10.0)
    async with console() as (app, pilot):
        await press(pilot, "slash", *"timer")
        app.post_message(Key("alt+f", "f"))
        await until(pilot, lambda: app.screen.query_one(LogFilter).value == "")
        await until(pilot, lambda: tabs(app).rstrip().endswith("186 lines · stays"))


async def test_a_slash_filters_the_log_from_wherever_one_is() -> None:
    async with console() as (app, pilot):
        await press(pilot, "slash", *"timer")
        assert app.screen.query_one(LogFilter).has_focus
        assert "[5 Log]" in tabs(app)
        assert tabs(app).rstrip().endswith(" of 186 lines · follows")
        assert "Timer CallBack" in text_of(app)
        assert "Odom CallBack" not in text_of(app)
        assert app.engines.latest.commands == []
        await press(pilot, "escape")
        assert "Odom CallBack" not in text_of(app)
        assert tabs(app).rstrip().endswith("186 lines · follows")


async def test_escape_in_the_log_clears_the_picked_line_then_the_filter() -> None:
    async with console() as (app, pilot):
        await press(pilot, "slash", *"timer", "enter", "up", "escape")
        assert " of 186 lines" in tabs(app)
        await press(pilot, "escape")
        assert " of 186 lines" not in tabs(app)
        assert "186 lines" in tabs(app)


@pytest.mark.slow
async def test_keys_that_are_typed_into_a_filter_do_nothing_else() -> None:
    async with console() as (app, pilot):
        await press(pilot, "slash", "s", "space", "left", "q", "right", "question_mark", "colon")
        assert app.screen.query_one(LogFilter).value == "sq ?:"
        assert app.engines.latest.commands == []


@pytest.mark.slow
async def test_the_frame_of_the_log_says_what_is_shown() -> None:
    async with console(WIDE) as (app, pilot):
        assert "5 Log 186 lines · follows" in text_of(app)
        await press(pilot, "slash", *"level:warn", "enter")
        assert "5 Log 1 of 186 lines · follows" in text_of(app)


@pytest.mark.slow
async def test_a_line_that_is_picked_moves_the_cursor_of_every_pane() -> None:
    async with console(WIDE) as (app, pilot):
        await press(pilot, "slash", *"SLEEPING==3", "enter", "up", "enter")
        assert "t 7.000 s" in lines_of(app)[0]
        assert app.screen.query_one(Lanes).now == ns(7.0)
        await press(pilot, "0")
        assert "● LIVE" in lines_of(app)[0]


@pytest.mark.slow
async def test_the_keys_of_the_log_are_offered_on_the_log_and_when_they_mean_something() -> None:
    async with console(WIDE) as (app, pilot):
        assert "f stay" not in lines_of(app)[-1]
        await press(pilot, LOG)
        assert "/ filter  f stay  ↑ ↓ line  y copy" in lines_of(app)[-1]
        assert "go there" not in lines_of(app)[-1]
        await press(pilot, "up")
        assert "f follow  ↑ ↓ line  ⏎ go there  y copy  esc clear" in lines_of(app)[-1]
        await press(pilot, "escape")
        assert "f stay  ↑ ↓ line  y copy" in lines_of(app)[-1]


@pytest.mark.slow
async def test_enter_goes_from_the_code_to_the_lane_and_back() -> None:
    async with console(WIDE) as (app, pilot):
        code, lanes = app.screen.query_one(CodeView), app.screen.query_one(Lanes)
        timer = next(each for each in lanes.timeline.entities.values() if each.callback == "timer_callback")
        code.show_callback(timer)
        await press(pilot, CODE, "enter")
        assert lanes.has_focus
        assert lanes.selection is not None
        assert lanes.selection.entity == timer.id
        assert lanes.selection.bar is not None
        code.action_let_go()
        await press(pilot, "enter")
        assert code.has_focus
        assert code.place.line == timer.first_line


async def test_f_says_where_the_log_is_followed_while_another_pane_is_in_front() -> None:
    async with console() as (app, pilot):
        await press(pilot, "f")
        [note] = app._notifications
        assert note.message == f"Only the log is followed or stays: {LOG} goes there."


@pytest.mark.slow
async def test_a_click_on_a_callback_selects_its_lane_and_stays_at_the_code() -> None:
    async with console(WIDE) as (app, pilot):
        code, lanes = app.screen.query_one(CodeView), app.screen.query_one(Lanes)
        timer = next(each for each in lanes.timeline.entities.values() if each.callback == "timer_callback")
        code.show_callback(timer)
        await settle(pilot)
        await pilot.click(CodeView, offset=(10, timer.first_line - code.scroll_offset.y))
        await settle(pilot)
        assert lanes.selection is not None
        assert lanes.selection.entity == timer.id
        assert code.has_focus


@pytest.mark.slow
async def test_what_is_copied_goes_to_the_terminals_clipboard() -> None:
    async with console() as (app, pilot):
        await press(pilot, "slash", *"SLEEPING==3", "enter", "y")
        assert app.clipboard == "[INFO] [7.000] [sub_node]: SLEEPING==3 seconds"
        assert "copied 1 line" in text_of(app)


@pytest.mark.slow
async def test_without_an_editor_the_key_says_what_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("EDITOR", raising=False)
    monkeypatch.delenv("VISUAL", raising=False)
    async with console() as (app, pilot):
        await press(pilot, "o")
        assert "no editor is named" in text_of(app)


@pytest.mark.slow
async def test_a_terminal_that_cannot_be_lent_is_told_of(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("EDITOR", "vi")
    async with console() as (app, pilot):
        await press(pilot, "o")
        assert "no editor can be opened" in text_of(app)


async def test_the_editor_is_opened_at_the_line_and_the_run_goes_on(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    told, go = tmp_path / "told", tmp_path / "go"
    editor = tmp_path / "vi"
    editor.write_text(
        f"#!{sys.executable}\n"
        "import sys, time, pathlib\n"
        f"pathlib.Path({str(told)!r}).write_text(' '.join(sys.argv[1:]))\n"
        f"while not pathlib.Path({str(go)!r}).exists(): time.sleep(0.01)\n"
    )
    monkeypatch.delenv("VISUAL", raising=False)
    editor.chmod(0o755)
    monkeypatch.setenv("EDITOR", str(editor))
    async with console() as (app, pilot):
        driver = app._driver
        assert driver is not None
        monkeypatch.setattr(type(driver), "can_suspend", True)
        monkeypatch.setattr(driver, "suspend_application_mode", lambda: None)
        monkeypatch.setattr(driver, "resume_application_mode", lambda: None)
        code = app.screen.query_one(CodeView)
        await press(pilot, CODE, "down")
        line = code.place.line
        # The pilot waits for a screen that is drawn, which none is meanwhile.
        app.lesson_screen.panes.action_open_source()
        while not told.exists():
            await asyncio.sleep(0.01)
        app.lesson_screen.post_message(RunController.Delivered(1, LATER))
        while app.lesson_screen.runs.run.timeline.end < ns(13.9):
            await asyncio.sleep(0.01)
        go.touch()
        while any(worker.group == "editor" for worker in app.workers):
            await asyncio.sleep(0.01)
        await settle(pilot)
        assert told.read_text() == f"+{line} {code.place.path}"
        assert "t 14.0" in lines_of(app)[0]


async def test_the_editor_is_opened_at_the_diagnosis_unless_a_line_of_the_code_is_chosen(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    opened: list[tuple[Path, int]] = []

    async def edit(_: object, path: Path, line: int) -> None:
        opened.append((path, line))

    monkeypatch.setattr(panes, "edit", edit)
    async with console() as (app, pilot):
        told = CodeLocation(str(tmp_path / "node.py"), 60, 62)
        line, code = app.screen.query_one(DiagnosisLine), app.screen.query_one(CodeView)
        line.diagnosis = Diagnosis("it waits", DiagnosisLevel.WAITS, place=told)
        app.lesson_screen.panes.action_open_source()
        await settle(pilot)
        await press(pilot, CODE, "down")
        line.diagnosis = Diagnosis("it waits", DiagnosisLevel.WAITS, place=told)
        app.lesson_screen.panes.action_open_source()
        await settle(pilot)
        assert opened == [(tmp_path / "node.py", 60), code.place]


@pytest.mark.slow
async def test_a_file_that_changed_on_disk_is_run_again_as_it_is_now(tmp_path: Path) -> None:
    path = tmp_path / "node.py"
    path.write_text("first = 1\n")
    engines = FakeEngines(EVENTS, ns(5.0))
    lesson_of_a_teacher = replace(of_file(path, [], "real"), is_own_file=False)
    app = CbtuiApp(start_program=lesson_of_a_teacher, open_session=engines)
    async with app.run_test(size=WIDE) as pilot:
        await settle(pilot)
        path.write_text("second = 2\n")
        app.screen.query_one(CodeView).check_disk()
        await settle(pilot)
        assert "2 Code node.py · changed on disk ─" in text_of(app)
        app.screen.post_message(RunController.Over(1, None))
        await settle(pilot)
        assert "2 Code node.py · changed; r runs it again" in text_of(app)
        await press(pilot, "r")
        assert "2 Code node.py ─" in text_of(app)
        assert "second = 2" in text_of(app)
