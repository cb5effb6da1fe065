import pytest
from textual.geometry import Size
from textual.pilot import Pilot
from textual.widgets import OptionList

from cbtui.app import CbtuiApp
from cbtui.screens.layout import Layout, layout_for, too_small
from cbtui.widgets.lanes import Lanes
from tests.support.builder import ns
from tests.support.console import NARROW, WIDE, RecordedConsole, settle
from tests.support.daily import first_daily
from tests.support.exercises import until
from tests.support.fake_session import FakeEngines
from tests.support.pictures import lines_of, text_of
from tests.support.runs import shared_group_run

EVENTS = shared_group_run().events


async def resize(pilot: Pilot[None], columns: int, rows: int) -> None:
    """Give the terminal a size, and wait until the screen has it."""
    await pilot.resize_terminal(columns, rows)
    await until(pilot, lambda: pilot.app.screen.size == (columns, rows))
    await pilot.pause()


@pytest.mark.parametrize(
    ("width", "height", "layout"),
    [
        (80, 24, Layout.TABBED),
        (79, 24, Layout.SMALL),
        (80, 23, Layout.SMALL),
        (140, 40, Layout.GRID),
        (200, 24, Layout.TABBED),
        (80, 60, Layout.TABBED),
        (0, 0, Layout.SMALL),
    ],
)
def test_the_size_decides_the_layout(width: int, height: int, layout: Layout) -> None:
    assert layout_for(Size(width, height)) is layout


def test_a_terminal_that_is_too_small_hears_what_is_needed() -> None:
    assert too_small(Size(60, 20)) == (
        "cbtui needs a terminal of 80 columns and 24 rows; this one has 60 columns and 20 rows."
    )


async def test_a_small_terminal_shows_the_sentence_and_nothing_else() -> None:
    app = RecordedConsole("shared-group", EVENTS, 13.15)
    async with app.run_test(size=(60, 24)) as pilot:
        for size in ((60, 24), (80, 10), (20, 5)):
            await resize(pilot, *size)
            await settle(pilot)
            assert " ".join(text_of(app).split()) == too_small(Size(*size))
        await resize(pilot, 1, 1)
        await settle(pilot)


async def test_the_menu_says_so_too() -> None:
    app = CbtuiApp(open_session=FakeEngines([], 0))
    async with app.run_test(size=(60, 20)):
        assert " ".join(text_of(app).split()) == too_small(Size(60, 20))


async def test_drawing_goes_on_when_the_terminal_is_large_enough_again() -> None:
    app = RecordedConsole("shared-group", EVENTS, 2.0)
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        await resize(pilot, 60, 20)
        app.engines.latest.play(ns(13.15))
        await settle(pilot)
        assert "this one has 60 columns" in " ".join(text_of(app).split())
        await resize(pilot, *NARROW)
        await settle(pilot)
        assert "t 13.15" in lines_of(app)[0]
        assert "odom_callback waits 9.1 s" in lines_of(app)[-2]


@pytest.mark.bulk
async def test_a_screen_that_grows_looks_as_if_it_had_always_been_so_large() -> None:
    pictures = []
    for first in (NARROW, WIDE, (60, 20)):
        app = RecordedConsole("shared-group", EVENTS, 13.15)
        async with app.run_test(size=first) as pilot:
            await settle(pilot)
            await resize(pilot, *WIDE)
            await settle(pilot)
            await pilot.pause()
            pictures.append(lines_of(app))
    assert pictures[0] == pictures[1] == pictures[2]


@pytest.mark.slow
async def test_lanes_diagnosis_and_keys_are_always_on_screen() -> None:
    app = RecordedConsole("shared-group", EVENTS, 13.15)
    async with app.run_test(size=NARROW) as pilot:
        for size in (NARROW, (100, 30), (119, 33), (120, 34), WIDE, (200, 60)):
            await resize(pilot, *size)
            await settle(pilot)
            assert app.screen.query_one(Lanes).size.height >= 7
            assert "odom_callback waits 9.1 s" in lines_of(app)[-2]
            assert "? help" in lines_of(app)[-1]
            assert {len(line) for line in lines_of(app)} == {size[0]}


@pytest.mark.slow
@pytest.mark.parametrize("page", first_daily("pageup", "pagedown"))
@pytest.mark.parametrize("window", ["p", "t"], ids=["set-up", "threads"])
async def test_a_window_that_opened_where_nothing_fits_has_no_pages(window: str, page: str) -> None:
    app = RecordedConsole("shared-group", EVENTS, 13.15)
    async with app.run_test(size=(20, 5)) as pilot:
        await settle(pilot)
        await pilot.press(window)
        await pilot.press(page)
        chosen = app.screen.query_one(OptionList).highlighted
        await resize(pilot, *NARROW)
        assert app.screen.query_one(OptionList).highlighted == chosen
