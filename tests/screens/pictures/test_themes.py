"""Every word on every screen is readable in each of the console's own themes."""

import pytest
from textual.app import App

from cbtui.app import CbtuiApp
from cbtui.looks.colour_themes import THEMES, palette_of
from cbtui.looks.contrast import contrast
from tests.support.console import NARROW, WIDE, RecordedConsole, settle
from tests.support.daily import first_daily
from tests.support.fake_session import FakeEngines
from tests.support.pictures import text_of
from tests.support.runs import shared_group_run

LEAST = {theme.name: palette_of(theme).words for theme in THEMES}
THEME = pytest.mark.parametrize("theme", first_daily(*LEAST))


def hard_to_read(app: App[None], least: float) -> dict[str, float]:
    """The words on screen that contrast less than they should with what is behind them."""
    found = {}
    for strip in app.screen._compositor.render_strips():
        for text, style, _ in strip:
            if style is None or style.color is None or style.bgcolor is None:
                continue
            now = contrast(style.color.get_truecolor(), style.bgcolor.get_truecolor())
            if now < least and any(map(str.isalnum, text)):
                found[text.strip()] = round(now, 1)
    return found


@THEME
@pytest.mark.parametrize("size", first_daily(WIDE, NARROW), ids=["140x40", "80x24"])
async def test_the_menu_is_readable(theme: str, size: tuple[int, int]) -> None:
    app = CbtuiApp(theme=theme, open_session=FakeEngines([], 0))
    async with app.run_test(size=size) as pilot:
        await pilot.press("down")
        await pilot.pause()
        assert hard_to_read(app, LEAST[theme]) == {}


@pytest.mark.slow
@THEME
async def test_a_lesson_and_its_windows_are_readable(theme: str) -> None:
    app = RecordedConsole("shared-group", shared_group_run().events, 14.25, theme=theme)
    async with app.run_test(size=WIDE) as pilot:
        for keys in ((), ("enter",), ("escape", "2"), ("6",), ("t",), ("escape", "question_mark")):
            await pilot.press(*keys)
            await settle(pilot)
            assert hard_to_read(app, LEAST[theme]) == {}, keys


@THEME
async def test_lines_that_are_set_off_are_readable(theme: str) -> None:
    app = RecordedConsole("shared-group", shared_group_run().events, 12.4, theme=theme)
    async with app.run_test(size=WIDE) as pilot:
        for keys in (("2",), ("down", "down"), ("5", "up", "up")):
            await pilot.press(*keys)
            await settle(pilot)
            assert hard_to_read(app, LEAST[theme]) == {}, keys


@THEME
async def test_a_question_is_readable_to_its_last_word(theme: str) -> None:
    app = CbtuiApp(theme=theme, start_lesson="shared-group", open_session=FakeEngines([], 0))
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        assert "your answer is final" in text_of(app)
        assert hard_to_read(app, LEAST[theme]) == {}


@pytest.mark.slow
@THEME
async def test_what_lies_after_the_cursor_is_readable_too(theme: str) -> None:
    app = RecordedConsole("shared-group", shared_group_run().events, 14.25, theme=theme)
    async with app.run_test(size=WIDE) as pilot:
        await settle(pilot)
        await pilot.press(*"[[[[")
        await settle(pilot)
        assert hard_to_read(app, LEAST[theme] * 2 / 3) == {}


@pytest.mark.slow
async def test_the_lanes_follow_the_theme() -> None:
    app = RecordedConsole("shared-group", shared_group_run().events, 14.25)
    async with app.run_test(size=WIDE) as pilot:
        for theme in (*LEAST, "nord", "textual-light"):
            app.theme = theme
            await settle(pilot)
            assert palette_of(app.current_theme).groups[0].lower() in app.export_screenshot().lower(), theme
