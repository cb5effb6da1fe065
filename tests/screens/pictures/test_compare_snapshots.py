from collections.abc import Callable

import pytest
from textual.pilot import Pilot

from cbtui.looks.theme import Charset
from tests.screens.test_compare import ComparingConsole, drawn, sides
from tests.support.console import NARROW, WIDE
from tests.support.daily import first_daily

Compare = Callable[..., bool]


async def settled(pilot: Pilot[None]) -> None:
    assert isinstance(pilot.app, ComparingConsole)
    await drawn(pilot.app, pilot)


@pytest.mark.parametrize("size", first_daily(WIDE, NARROW), ids=["140x40", "80x24"])
def test_two_runs_look_as_they_did(snap_compare: Compare, size: tuple[int, int]) -> None:
    assert snap_compare(ComparingConsole(*sides()), terminal_size=size, run_before=settled)


def test_a_table_that_fills_the_screen_looks_as_it_did(snap_compare: Compare) -> None:
    async def enlarge(pilot: Pilot[None]) -> None:
        await pilot.press("z", "w", "left_square_bracket")
        await settled(pilot)

    assert snap_compare(ComparingConsole(*sides()), terminal_size=NARROW, run_before=enlarge)


@pytest.mark.slow
def test_lanes_of_two_runs_that_fill_the_screen_look_as_they_did(snap_compare: Compare) -> None:
    async def enlarge(pilot: Pilot[None]) -> None:
        await pilot.press("Z")
        await settled(pilot)

    assert snap_compare(ComparingConsole(*sides()), terminal_size=NARROW, run_before=enlarge)


@pytest.mark.slow
def test_two_runs_in_ascii_look_as_they_did(snap_compare: Compare) -> None:
    app = ComparingConsole(*sides(), charset=Charset.ASCII)
    assert snap_compare(app, terminal_size=WIDE, run_before=settled)
