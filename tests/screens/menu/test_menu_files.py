"""Files of the person's own: those that were opened lately, and any whose path is typed."""

from pathlib import Path
from typing import Any

import pytest
from textual.screen import Screen

from cbtui.app import CbtuiApp
from cbtui.runs.setup.recent import RecentEntry, RecentKind, RecentList
from cbtui.screens.lesson import LessonScreen
from cbtui.screens.menu import MenuScreen
from cbtui.screens.replay import ReplayScreen
from cbtui.screens.windows.open_file import PathInput
from cbtui.widgets.description_pane import DescriptionPane
from sim import recording
from sim.engine.setup import ProgramSetup
from tests.recording.files import write
from tests.support.console import NARROW, TALL
from tests.support.fake_session import FakeEngines
from tests.support.pictures import lines_of, text_of
from tests.support.runs import shared_group_run


def told(app: CbtuiApp) -> str:
    """What is told of the highlighted file."""
    description = app.screen.query_one(DescriptionPane).description
    assert description is not None
    return description.text


def shows(app: CbtuiApp, kind: type[Screen[Any]]) -> bool:
    return isinstance(app.screen, kind)


def menu() -> CbtuiApp:
    return CbtuiApp(open_session=FakeEngines([], 0))


@pytest.fixture
def program(tmp_path: Path) -> Path:
    path = tmp_path / "my_node.py"
    path.write_text("pass\n")
    return path


def remember(path: Path, **how: Any) -> None:
    RecentList().note(RecentEntry(RecentKind.PROGRAM, str(path), 100, **how))


async def test_a_program_that_was_opened_lately_can_be_opened_again_as_it_was(program: Path) -> None:
    remember(program, arguments=("-x",), clock="virtual")
    engines = FakeEngines([], 0)
    app = CbtuiApp(open_session=engines)
    async with app.run_test(size=TALL) as pilot:
        assert "my_node.py          program" in text_of(app)
        await pilot.press("up")
        assert "runs it again, on the virtual clock" in told(app)
        await pilot.press("enter")
        assert isinstance(app.screen, LessonScreen)
        setup = engines.latest.setup
        assert (setup.programs[0], setup.clock) == (ProgramSetup(str(program), ("-x",)), "virtual")


async def test_a_file_given_to_the_command_is_among_the_recent_ones(
    program: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(program.parent)
    app = CbtuiApp(start_file=(Path("my_node.py"), [], "real"), open_session=FakeEngines([], 0))
    async with app.run_test(size=TALL) as pilot:
        await pilot.press("q")
        await pilot.pause()
        assert "my_node.py" in text_of(app)
    assert RecentList().files[0].what == str(program)


async def test_a_file_that_is_gone_is_said_to_be_and_can_be_taken_off_the_list(program: Path) -> None:
    remember(program)
    program.unlink()
    app = menu()
    async with app.run_test(size=NARROW) as pilot:
        assert "delete" not in text_of(app)
        await pilot.press("up")
        assert told(app) == "The file my_node.py is gone."
        assert "del remove" in lines_of(app)[-1]
        await pilot.press("enter")
        assert isinstance(app.screen, MenuScreen)
        assert any("There is no file" in note.message for note in app._notifications)
        await pilot.press("delete")
        await pilot.pause()
        assert "Recent" not in text_of(app)
    assert RecentList().files == []


async def test_a_recording_is_shown_and_nothing_in_it_is_run(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    write(path, shared_group_run().events, recording.RecordingMetadata(title="run.mcap", clock="virtual"))
    RecentList().note(RecentEntry(RecentKind.RECORDING, str(path), 100))
    engines = FakeEngines([], 0)
    app = CbtuiApp(open_session=engines)
    async with app.run_test(size=NARROW) as pilot:
        await pilot.press("up", "enter")
        assert isinstance(app.screen, ReplayScreen)
        assert not any(session.setup.title == "run.mcap" for session in engines.sessions)


# a file of one's own


async def test_o_opens_a_program_whose_path_is_typed(program: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(program.parent)
    engines = FakeEngines([], 0)
    app = CbtuiApp(open_session=engines)
    async with app.run_test(size=TALL) as pilot:
        await pilot.press("o", *"my_", "tab", "enter")
        assert isinstance(app.screen, LessonScreen)
        assert engines.latest.setup.programs == (ProgramSetup(str(program)),)
        await pilot.press("q")
        await pilot.pause()
        assert shows(app, MenuScreen)
        assert "my_node.py" in text_of(app)


async def test_o_shows_a_recording(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    write(path, shared_group_run().events, recording.RecordingMetadata(title="run.mcap", clock="virtual"))
    app = menu()
    async with app.run_test(size=NARROW) as pilot:
        await pilot.press("o")
        app.screen.query_one(PathInput).value = str(path)
        await pilot.press("enter")
        assert isinstance(app.screen, ReplayScreen)
    assert RecentList().files[0].kind is RecentKind.RECORDING


async def test_a_path_that_cannot_be_opened_is_said_and_can_be_mended(
    program: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(program.parent)
    app = menu()
    async with app.run_test(size=NARROW) as pilot:
        await pilot.press("o", *"my.py", "enter")
        await pilot.pause()
        assert "There is no file my.py." in text_of(app)
        await pilot.press("backspace", "backspace", "backspace", "tab", "enter")
        assert isinstance(app.screen, LessonScreen)


async def test_tab_lists_what_a_path_could_go_on_with(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("one.py", "other.py"):
        (tmp_path / name).write_text("")
    app = menu()
    async with app.run_test(size=NARROW) as pilot:
        await pilot.press("o", "tab")
        await pilot.pause()
        assert "one.py  other.py" in text_of(app)
        await pilot.press("x", "tab")
        await pilot.pause()
        assert "begins like that" in text_of(app)
        await pilot.press("escape")
        assert isinstance(app.screen, MenuScreen)
