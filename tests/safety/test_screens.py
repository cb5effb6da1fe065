"""No pane, window or notice hands on to the terminal what somebody else wrote for it to obey."""

from collections.abc import Callable
from pathlib import Path

import pytest
from textual.app import App
from textual.pilot import Pilot

from cbtui.app import CbtuiApp
from cbtui.runs.compared_runs import ComparedRun, ComparisonTerms
from cbtui.runs.setup.recent import RecentEntry, RecentKind, RecentList
from sim.recording import read
from sim.trace.events import AnyEvent
from tests.safety import hostile
from tests.safety.hostile import HOSTILE, obeyed
from tests.support.console import NARROW, WIDE, RecordedConsole, settle
from tests.support.daily import first_row_daily
from tests.support.fake_session import FakeEngines

_NAME = "\x1b[2J\x9b31m\u202e[red]x[/red]\udc9b"


def drawn(app: App[None]) -> str:
    """All text that is sent to the terminal for the screen as it is."""
    return "\n".join(
        "".join(segment.text for segment in strip) for strip in app.screen._compositor.render_strips()
    )


async def walk(pilot: Pilot[None], *keys: str) -> str:
    """What is drawn at first and after each key; fails where a terminal would obey some of it."""
    texts = []
    for key in ("", *keys):
        if key:
            await pilot.press(key)
        await settle(pilot)
        texts.append(drawn(pilot.app))
        assert not obeyed(texts[-1]), f"after {key or 'the beginning'} on {type(pilot.app.screen).__name__}"
    return "\n".join(texts)


@pytest.fixture(autouse=True)
def nobodys(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for kind in ("CONFIG", "DATA", "STATE", "CACHE"):
        monkeypatch.setenv(f"XDG_{kind}_HOME", str(tmp_path / "home" / kind))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("size", "told"), first_row_daily((NARROW, hostile.events), (WIDE, hostile.every_event))
)
async def test_a_run_full_of_hostile_texts_is_shown_in_every_pane(
    size: tuple[int, int], told: Callable[[], list[AnyEvent]]
) -> None:
    app = RecordedConsole("split-groups", told(), 3.0)
    app.animation_level = "none"
    async with app.run_test(size=size, notifications=True) as pilot:
        shown = await walk(pilot, *("1", "2", "3", "4", "5", "6", "down", "enter", "d", "escape", "t"))
    assert "ZXZpbA" in shown
    assert "[red]r[/red]" in shown


@pytest.mark.slow
async def test_a_hostile_recording_is_shown_whole(tmp_path: Path) -> None:
    app = CbtuiApp(start_recording=read(hostile.recording(tmp_path / "run.mcap")))
    app.animation_level = "none"
    async with app.run_test(size=WIDE, notifications=True) as pilot:
        shown = await walk(pilot, "3", "4", "6", "[", "enter", "?")
    assert "ZXZpbA" in shown


async def test_a_comparison_of_hostile_recordings_is_shown(tmp_path: Path) -> None:
    sides = [
        ComparedRun(f"{name}{HOSTILE}", hostile.recording(tmp_path / f"{name}.mcap"))
        for name in ("before", "after")
    ]
    app = CbtuiApp(start_comparison=(sides[0], sides[1], ComparisonTerms()))
    app.animation_level = "none"
    async with app.run_test(size=WIDE, notifications=True) as pilot:
        await walk(pilot, "tab", "down", "tab", "down")


async def test_the_menu_shows_hostile_lessons_and_names_of_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CBTUI_LESSONS", str(hostile.lesson(tmp_path / "theirs").parent))
    recents = RecentList()
    for kind, ending in ((RecentKind.PROGRAM, "py"), (RecentKind.RECORDING, "mcap")):
        recents.note(RecentEntry(kind, str(tmp_path / f"{_NAME}.{ending}"), 0, (HOSTILE,)))
    app = CbtuiApp(open_session=FakeEngines([], 0))
    app.animation_level = "none"
    async with app.run_test(size=WIDE, notifications=True) as pilot:
        shown = await walk(pilot, "end", "up", "up", "enter")
    assert "ZXZpbA" in shown


@pytest.mark.slow
async def test_a_hostile_lesson_is_shown_with_its_guide_its_question_and_its_exercise(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CBTUI_LESSONS", str(hostile.lesson(tmp_path / "theirs").parent))
    monkeypatch.chdir(tmp_path)
    app = CbtuiApp(open_session=FakeEngines(hostile.events(), 0), start_lesson="bad-lesson")
    app.animation_level = "none"
    async with app.run_test(size=WIDE, notifications=True) as pilot:
        shown = await walk(pilot, "enter", "escape", "3", "6", "h", "h", "E")
    assert "ZXZpbA" in shown


async def test_a_notice_is_shown_and_not_obeyed() -> None:
    app = CbtuiApp(open_session=FakeEngines([], 0))
    app.animation_level = "none"
    async with app.run_test(size=WIDE, notifications=True) as pilot:
        app.notify(HOSTILE, title=HOSTILE, markup=False)
        shown = await walk(pilot)
    assert "[red]r[/red]" in shown
