"""More lanes than there is room for: how many, by which key they come into sight, and that they do."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import pytest
from textual.pilot import Pilot

from cbtui.keys.keymap import Keymap
from cbtui.widgets.guide import Guide
from cbtui.widgets.lanes import Lanes
from sim.trace.events import AnyEvent
from tests.support.console import NARROW, RecordedConsole, settle
from tests.support.pictures import picture_of
from tests.support.runs import Run


def many_groups(groups: int) -> list[AnyEvent]:
    """One thread, and so many groups of one subscription each."""
    run = Run()
    thread, node = run.thread("MainThread"), run.node("/node")
    for number in range(groups):
        topic = run.subscription(run.exclusive(node), f"/t{number}", f"t{number}_callback")
        run.callback(topic, thread, 1.0 + number / 10, 0.05)
    run.stop(5.0)
    return run.events


@asynccontextmanager
async def console(
    groups: int, keys: Keymap | None = None
) -> AsyncIterator[tuple[RecordedConsole, Pilot[None]]]:
    app = RecordedConsole("shared-group", many_groups(groups), 5.0, keys=keys)
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        yield app, pilot


async def press(pilot: Pilot[None], *keys: str) -> None:
    for key in keys:
        await pilot.press(key)
        await settle(pilot)


def lanes_of(app: RecordedConsole) -> str:
    return picture_of(app, app.lesson_screen.query_one(Lanes))


async def test_lanes_that_have_no_room_are_counted_with_the_key_that_shows_them() -> None:
    async with console(12, Keymap({"lesson.enlarge_lanes": ("f9",)})) as (app, pilot):
        assert "+5 lanes f9 │" in lanes_of(app)
        assert "/motor_power" not in lanes_of(app)
        await press(pilot, "f9")
        assert "seconds     │" in lanes_of(app)
        assert "/motor_power" in lanes_of(app)
        assert len(lanes_of(app).splitlines()) == 21


@pytest.mark.slow
async def test_lanes_that_are_more_than_a_screen_are_gone_through_with_the_arrows() -> None:
    async with console(30) as (app, pilot):
        assert "+23 lanes Z │" in lanes_of(app)
        await press(pilot, "Z")
        assert "+12 ↑ ↓     │" in lanes_of(app)
        assert "t25" not in lanes_of(app)
        await pilot.press(*["down"] * 27)
        await settle(pilot)
        assert "Z excl t25  ▸" in lanes_of(app)


@pytest.mark.slow
async def test_lanes_give_the_panes_their_room_back() -> None:
    async with console(12) as (app, pilot):
        guide, before = app.lesson_screen.query_one(Guide), lanes_of(app)
        for key in ("Z", "z", "escape", "1"):
            await press(pilot, "Z")
            assert lanes_of(app) != before
            await press(pilot, key)
            assert lanes_of(app) == before
            assert guide.has_focus


@pytest.mark.slow
async def test_a_pane_that_fills_the_screen_makes_way_for_the_lanes() -> None:
    async with console(12) as (app, pilot):
        await press(pilot, "z")
        assert not app.lesson_screen.query_one(Lanes).display
        await press(pilot, "Z")
        assert "/motor_power" in lanes_of(app)
