"""A console whose keys were chosen by somebody."""

import pytest
from textual.command import Hit
from textual.widgets import Static

from cbtui.app import CbtuiApp
from cbtui.keys.command_palette import ActionsProvider
from cbtui.keys.config import read_text
from cbtui.keys.keymap import Keymap
from cbtui.screens.menu import MenuScreen
from cbtui.screens.windows.help import HelpScreen
from cbtui.widgets.key_bar import KeyBar
from cbtui.widgets.lanes import Lanes
from cbtui.widgets.shell import Prompt
from tests.support.console import WIDE, RecordedConsole, settle
from tests.support.runs import shared_group_run


def keymap(*entries: str) -> Keymap:
    config, complaints = read_text("\n".join(["[keys]", *entries]), "config.toml")
    assert complaints == []
    return config.keymap


def console(*entries: str) -> RecordedConsole:
    return RecordedConsole("shared-group", shared_group_run().events, 14.25, keys=keymap(*entries))


def footer(app: CbtuiApp) -> str:
    bar = app.screen.query_one(KeyBar)
    return "".join(run.text for run in bar.rows(bar.size)[0])


async def test_a_key_that_was_given_away_does_nothing_and_the_new_one_does() -> None:
    app = console('lesson.maximise = "f9"')
    async with app.run_test(size=WIDE) as pilot:
        await settle(pilot)
        await pilot.press("z")
        assert not app.lesson_screen.has_class("-maximised")
        await pilot.press("f9")
        assert app.lesson_screen.has_class("-maximised")


async def test_moving_one_of_two_that_share_a_key_leaves_the_other_its_key() -> None:
    app = console('lesson.resume = "f5"')
    async with app.run_test(size=WIDE) as pilot:
        await settle(pilot)
        await pilot.press("space")
        assert app.lesson_screen.runs.run.paused
        await pilot.press("space")
        assert app.lesson_screen.runs.run.paused
        await pilot.press("f5")
        assert not app.lesson_screen.runs.run.paused


async def test_what_says_why_an_action_is_not_available_has_the_key_of_the_action() -> None:
    app = console('lesson.compare = "f9"', 'lesson.threads = "C"')
    async with app.run_test(size=WIDE) as pilot:
        await settle(pilot)
        await pilot.press("f9")
        await settle(pilot)
        assert [note.message[:31] for note in app._notifications] == ["There is only one run so far: c"]


async def test_keys_that_were_swapped_are_swapped() -> None:
    app = console('lesson.zoom_in = "<"', 'lesson.zoom_out = ">"')
    async with app.run_test(size=WIDE) as pilot:
        await settle(pilot)
        before = app.screen.query_one(Lanes).window
        await pilot.press("<")
        await settle(pilot)
        after = app.screen.query_one(Lanes).window
        assert after.end - after.start < before.end - before.start


@pytest.mark.slow
async def test_footer_help_and_palette_show_the_keys_in_force() -> None:
    app = console('lesson.pause = "f5"', 'lesson.resume = "f5"', 'everywhere.help = ["f1", "?"]')
    async with app.run_test(size=WIDE) as pilot:
        await settle(pilot)
        assert "f5 pause" in footer(app)
        assert "f1 help" in footer(app)
        await pilot.press("f1")
        assert isinstance(app.screen, HelpScreen)
        text = app.screen.query_one("#beside", Static).render()
        assert "f5  Pause" in str(text)
        await pilot.press("escape")
        palette = ActionsProvider(app.screen)
        hits = [hit async for hit in palette.search("Stop time")]
        assert [hit.help for hit in hits if isinstance(hit, Hit)] == ["key f5"]


@pytest.mark.slow
async def test_a_letter_given_to_a_key_of_the_panes_can_still_be_typed() -> None:
    app = console('lesson.pan_earlier = "v"', 'lesson.deselect = "b"')
    async with app.run_test(size=WIDE) as pilot:
        await settle(pilot)
        await pilot.press("colon", "v", "b")
        assert app.screen.query_one(Prompt).value == "vb"


async def test_what_is_wrong_in_the_configuration_is_told_on_the_first_screen() -> None:
    app = CbtuiApp(complaints=["config.toml:3: there is no action [x]"])
    async with app.run_test(size=WIDE) as pilot:
        await pilot.pause()
        assert isinstance(app.screen, MenuScreen)
        assert [note.message for note in app._notifications] == ["config.toml:3: there is no action [x]"]


@pytest.mark.parametrize("theme", ["light", "high-contrast", "nord"])
async def test_the_console_begins_with_the_theme_that_was_chosen(theme: str) -> None:
    app = CbtuiApp(theme=theme)
    async with app.run_test(size=WIDE):
        assert app.current_theme.name == theme
