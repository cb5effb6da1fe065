"""Jumping: which places have a letter, and where typing it leads."""

import re

import pytest
from textual.pilot import Pilot

from cbtui.app import CbtuiApp
from cbtui.runs.compared_runs import ComparedSide
from cbtui.screens.compare import CompareScreen
from cbtui.screens.windows.jump import JumpScreen
from cbtui.widgets.code import CodeView
from cbtui.widgets.lanes import Lanes
from cbtui.widgets.log import LogLines
from cbtui.widgets.menu_list import MenuList
from lessons.lesson import Lesson
from lessons.puzzles import Puzzle
from sim.trace.model import Wait
from tests.support.builder import ns
from tests.support.console import NARROW, WIDE, RecordedConsole, settle
from tests.support.fake_session import FakeEngines
from tests.support.pictures import lines_of, picture_of, text_of
from tests.support.runs import shared_group_run
from tests.widgets.pictures import told

EVENTS = shared_group_run().events


async def jump_to(app: CbtuiApp, pilot: Pilot[None], text: str) -> None:
    """Type the letter that stands before a text on the screen."""
    await pilot.press("j")
    await pilot.pause()
    found = re.search(rf"\[(\w)\]{text}", text_of(app))
    assert found is not None, text_of(app)
    await pilot.press(found[1])
    await settle(pilot)


@pytest.mark.slow
@pytest.mark.parametrize(("size", "charset"), [(NARROW, "braille"), (NARROW, "ascii"), (WIDE, "braille")])
async def test_a_letter_leads_to_a_pane(size: tuple[int, int], charset: str) -> None:
    app = RecordedConsole("shared-group", EVENTS, 12.9, charset=charset)
    async with app.run_test(size=size) as pilot:
        await settle(pilot)
        await pilot.press("j")
        await pilot.pause()
        found = re.search(r" (\w) Code |\[(\w)\] ?Code ", text_of(app))
        assert found is not None, text_of(app)
        await pilot.press(found[1] or found[2])
        await settle(pilot)
        assert app.lesson_screen.query_one(CodeView).has_focus


async def test_letters_of_tabs_take_the_place_of_the_numbers_and_leave_the_brackets() -> None:
    app = RecordedConsole("shared-group", EVENTS, 12.9)
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        place = next(place for place, line in enumerate(lines_of(app)) if "[1 Guide]" in line)
        await pilot.press("j")
        await pilot.pause()
        assert re.match(r"─\[[a-z] Guide\] [a-z] Code  [a-z] Factory ", lines_of(app)[place])


async def test_a_letter_on_a_bar_selects_it_and_goes_to_its_moment() -> None:
    app = RecordedConsole("shared-group", EVENTS, 12.9)
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        await jump_to(app, pilot, "waits 8.9 s: A held")
        lanes = app.lesson_screen.query_one(Lanes)
        assert lanes.selection is not None
        assert isinstance(lanes.selection.bar, Wait)
        assert lanes.now == ns(4.003)
        assert lanes.has_focus


async def test_a_letter_on_a_line_of_the_log_goes_to_its_time() -> None:
    app = RecordedConsole("shared-group", EVENTS, 12.9)
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        await pilot.press("5")
        line = app.lesson_screen.query_one(LogLines)
        await jump_to(app, pilot, r"\S+ \[12.000")
        assert line.picked is not None


async def test_a_letter_in_the_menu_highlights_its_entry_and_one_in_a_comparison_goes_to_its_bar() -> None:
    app = CbtuiApp(open_session=FakeEngines(EVENTS, ns(0)))
    async with app.run_test(size=WIDE) as pilot:
        await settle(pilot)
        await jump_to(app, pilot, " 2  One shared group")
        chosen = app.screen.query_one(MenuList).chosen
        assert isinstance(chosen, Lesson)
        assert chosen.id == "shared-group"
        side = ComparedSide("as it was", told(shared_group_run()))
        app.push_screen(CompareScreen(side, side, app.charset))
        await settle(pilot)
        await jump_to(app, pilot, "dom ")
        assert app.screen.query(Lanes).first().selection is not None


@pytest.mark.parametrize("last", [False, True], ids=["top", "bottom"])
async def test_in_a_menu_with_long_headings_each_entry_in_view_has_a_letter_of_its_own(last: bool) -> None:
    async with CbtuiApp(open_session=FakeEngines(EVENTS, ns(0))).run_test(size=NARROW) as pilot:
        await settle(pilot)
        await pilot.press("end" if last else "home")
        menu = pilot.app.screen.query_one(MenuList)
        shown = dict(enumerate(picture_of(pilot.app, menu).splitlines()))
        entries = {row: line for row, line in shown.items() if line.lstrip().startswith("·")}
        for target in menu.jump_targets():
            target.go()
            assert isinstance(menu.chosen, Lesson | Puzzle)
            assert menu.chosen.title in entries.pop(target.place.y)
        assert not entries


async def test_any_other_key_leaves_and_meanwhile_the_picture_stands() -> None:
    app = RecordedConsole("shared-group", EVENTS, 12.9)
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        await pilot.press("j")
        await pilot.pause()
        assert "esc leave, a letter goes there" in lines_of(app)[-1]
        lanes = app.screen_stack[-2].query_one(Lanes)
        app.engines.latest.play(ns(20))
        await pilot.pause(0.2)
        assert lanes.now == ns(12.9)
        await pilot.press("escape")
        await settle(pilot)
        assert not isinstance(app.screen, JumpScreen)
        assert lanes.now == ns(20)
        assert lanes.selection is None
