"""What the terminal gets of a key that opens another screen, before that screen is mounted."""

from pathlib import Path
from typing import Any

import pytest
from textual.app import App
from textual.screen import Screen

from cbtui.app import CbtuiApp
from tests.support.console import NARROW, RecordedConsole, settle
from tests.support.engine_runs import run_lesson

LESSON = "split-groups"


@pytest.fixture
def sent(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """What was sent to the terminal so far."""
    texts: list[str] = []

    def note(app: App[None], screen: Screen[Any], update: Any) -> None:
        if update is not None:
            texts.append(update.render_segments(app.console))

    monkeypatch.setattr(App, "_display", note)
    return texts


@pytest.fixture
def console(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> CbtuiApp:
    monkeypatch.chdir(tmp_path)
    return RecordedConsole(LESSON, run_lesson(LESSON, 2.0).events, 2.0)


async def test_a_key_says_at_once_what_it_opens(console: CbtuiApp, sent: list[str]) -> None:
    async with console.run_test(size=NARROW) as pilot:
        await settle(pilot)
        for keys, key, words in (
            (("ctrl+r",), "C", "opening …"),
            (("q",), "e", "opening the exercise"),
            (("e", "q"), "enter", "opening lesson 3: Split groups"),
            ((), "n", "opening lesson 4: "),
        ):
            for each in keys:
                await pilot.press(each)
                await settle(pilot)
            screen, before = console.screen, len(sent)
            await pilot.press(key)
            await settle(pilot)
            assert console.screen is not screen
            assert any(words in text for text in sent[before:]), words


async def test_keys_are_shown_again_where_nothing_opened(console: CbtuiApp, sent: list[str]) -> None:
    async with console.run_test(size=NARROW) as pilot:
        await settle(pilot)
        Path(f"{LESSON}.py").mkdir()
        await pilot.press("e")
        await settle(pilot)
        assert "opening" not in sent[-1]
