"""Selecting on the lanes, by keys and mouse: what stands out, where the cursor goes, what is told."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import pytest
from textual.pilot import Pilot

from cbtui.keys.keymap import Keymap
from cbtui.widgets.code import CodeView
from cbtui.widgets.guide import Guide
from cbtui.widgets.lanes import Lanes, start_of
from cbtui.widgets.lanes.details import details_of_selection
from cbtui.widgets.lanes.rows import MemberLane, ThreadLane, all_lanes
from cbtui.widgets.lanes.selection import Selection
from tests.support.builder import ns
from tests.support.console import NARROW, WIDE, RecordedConsole, settle
from tests.support.daily import first_daily
from tests.support.pictures import lines_of, text_of
from tests.support.runs import shared_group_run, split_groups_run

EVENTS = shared_group_run().events


@asynccontextmanager
async def console(size: tuple[int, int] = NARROW) -> AsyncIterator[tuple[RecordedConsole, Pilot[None]]]:
    """A console on a lesson, 12.9 s into its run: everybody waits for the timer."""
    app = RecordedConsole("shared-group", EVENTS, 12.9)
    async with app.run_test(size=size) as pilot:
        await settle(pilot)
        yield app, pilot


async def press(pilot: Pilot[None], *keys: str) -> None:
    await pilot.press(*keys)
    await settle(pilot)


async def click(pilot: Pilot[None], column: int, row: int) -> None:
    await pilot.click(Lanes, offset=(column, row))
    await settle(pilot)


def lanes_of(app: RecordedConsole) -> Lanes:
    return app.screen.query_one(Lanes)


@pytest.mark.parametrize("size", first_daily(WIDE, NARROW))
async def test_enter_selects_what_runs_now_and_tells_of_it(size: tuple[int, int]) -> None:
    async with console(size) as (app, pilot):
        assert "▸ A" not in text_of(app)
        await press(pilot, "enter")
        assert "▸ A timer_callback on MainThread · has run since 4.000 s, for 8.9 s" in text_of(app)
        assert lanes_of(app).has_focus


async def test_up_and_down_go_from_lane_to_lane_and_stay_at_the_ends() -> None:
    async with console() as (app, pilot):
        await press(pilot, "enter", "down", "down")
        selection = lanes_of(app).selection
        assert selection is not None
        assert isinstance(selection.lane, MemberLane)
        assert "▸ A odom_callback waits · 8.9 s from 4.003 s · group A held by timer_callback" in text_of(app)
        await press(pilot, *["up"] * 5)
        selection = lanes_of(app).selection
        assert selection is not None
        assert isinstance(selection.lane, ThreadLane)


async def test_the_way_to_another_bar_is_offered_where_there_may_be_one() -> None:
    async with console() as (app, pilot):
        screen = app.lesson_screen

        def offered() -> list[bool]:
            keys = ("previous_event", "next_event", "earlier")
            return [screen.check_action(key, ()) is True for key in keys]

        assert offered() == [True, False, True]
        screen.navigation.seek(0)
        assert offered() == [False, True, False]
        screen.navigation.seek(ns(5.0))
        assert offered() == [True, True, True]
        await press(pilot, "enter")
        assert offered() == [True, False, True]  # the timer runs up to the end


@pytest.mark.slow
async def test_the_arrows_belong_to_the_panes_until_the_lanes_are_gone_to() -> None:
    async with console() as (app, pilot):
        guide = app.screen.query_one(Guide)
        await press(pilot, "down")
        assert lanes_of(app).selection is None
        assert guide.scroll_y > 0
        await press(pilot, "enter", "escape")
        assert lanes_of(app).selection is None
        assert guide.has_focus
        assert "▸ A" not in text_of(app)


async def test_braces_go_from_bar_to_bar_with_the_cursor() -> None:
    async with console() as (app, pilot):
        timeline = app.lesson_screen.runs.run.timeline
        await press(pilot, "enter", "down", "down", "left_curly_bracket")
        lanes = lanes_of(app)
        assert lanes.selection is not None
        assert lanes.selection.bar is not None
        first = start_of(lanes.selection.bar)
        assert lanes.now == first == ns(4.003)
        await press(pilot, "left_curly_bracket")
        assert lanes.now < first
        await press(pilot, "right_curly_bracket")
        assert lanes.now == first
        await press(pilot, "right_curly_bracket")
        assert lanes.now == first
        assert timeline.end == ns(12.9)


async def test_enter_on_a_selected_bar_goes_to_its_code() -> None:
    async with console() as (app, pilot):
        await press(pilot, "enter", "enter")
        code = app.screen.query_one(CodeView)
        assert code.display
        assert code.has_focus
        line = app.lesson_screen.runs.run.timeline.entities[3].first_line
        assert code.scroll_offset.y <= line - 1 < code.scroll_offset.y + code.size.height


@pytest.mark.slow
async def test_a_click_on_a_lane_moves_the_cursor_there_and_selects_the_bar() -> None:
    async with console() as (app, pilot):
        await click(pilot, 13 + 5, 0)
        lanes = lanes_of(app)
        assert lanes.now == ns(4.0)
        assert "▸ A timer_callback on MainThread · has run since 4.000 s" in text_of(app)
        assert "BACK" in lines_of(app)[0]


@pytest.mark.slow
async def test_a_click_on_a_lanes_name_selects_it_and_leaves_the_cursor() -> None:
    async with console() as (app, pilot):
        await click(pilot, 2, 3)
        selection = lanes_of(app).selection
        assert selection is not None
        assert isinstance(selection.lane, MemberLane)
        assert selection.lane.entity.name == "/scan"
        assert "LIVE" in lines_of(app)[0]


@pytest.mark.slow
async def test_a_click_on_the_axis_moves_the_cursor_alone() -> None:
    async with console() as (app, pilot):
        await click(pilot, 13 + 10, 6)
        assert lanes_of(app).selection is None
        assert lanes_of(app).now == ns(5.0)


async def test_enter_before_the_first_callback_says_that_there_is_nothing_to_select() -> None:
    app = RecordedConsole("shared-group", [], 0.0)
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        assert "STARTING" in lines_of(app)[0]
        await press(pilot, "enter")
        told = [each.message for each in app._notifications]
        assert told == ["There is no bar to select yet: the lanes come with the first callbacks."]
        app.lesson_screen.runs.timeline.extend(EVENTS[:100])
        app.lesson_screen.draw()
        assert not list(app._notifications), "there are bars now"


async def test_what_is_told_of_a_lane_that_was_selected_empty_follows_its_bars() -> None:
    app = RecordedConsole("shared-group", EVENTS, 0.3)
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        lanes = lanes_of(app)
        *_, lane = (each for each in all_lanes(lanes.timeline, "") if isinstance(each, MemberLane))
        app.lesson_screen.bars.select(Selection(lane))
        await settle(pilot)
        for now in (0.3, 4.5):
            app.engines.latest.play(ns(now))
            await settle(pilot)
            assert ("nothing up to here on screen" in text_of(app)) is (now == 0.3)
        assert lanes.selection_now is not None
        await press(pilot, "y")
        assert "nothing up to here" not in app.clipboard


@pytest.mark.slow
async def test_the_wheel_zooms() -> None:
    async with console() as (app, pilot):
        lanes = lanes_of(app)
        lanes.post_message(Lanes.WheelTurned(-1))
        await settle(pilot)
        assert lanes.window.length == ns(5)


async def test_the_arrows_pan_and_leave_the_cursor_and_every_other_pane() -> None:
    async with console() as (app, pilot):
        status, window = lines_of(app)[0], lanes_of(app).window
        await press(pilot, "left", "left")
        assert lanes_of(app).window.start == window.start - ns(2)
        assert lines_of(app)[0] == status
        assert "now▸" in text_of(app)
        await press(pilot, "0")
        assert lanes_of(app).window == window


@pytest.mark.slow
async def test_panning_ends_where_the_run_does() -> None:
    async with console(WIDE) as (app, pilot):
        await press(pilot, *["left"] * 9)
        assert lanes_of(app).window.start == 0
        assert "pan →" in text_of(app)
        await press(pilot, *["right"] * 9)
        assert "pan ←" in text_of(app)
        app.engines.latest.play(ns(14))
        await settle(pilot)
        assert lanes_of(app).window.end == ns(14)


@pytest.mark.slow
async def test_a_selection_does_not_outlive_its_run() -> None:
    async with console() as (app, pilot):
        await press(pilot, "enter", "t", "2")
        assert lanes_of(app).selection is None


@pytest.mark.slow
async def test_lanes_without_anything_can_be_gone_to() -> None:
    app = RecordedConsole("shared-group", [], 0.0)
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        await press(
            pilot, "enter", "down", "up", "enter", "left_curly_bracket", "right_curly_bracket", "escape"
        )
        assert lanes_of(app).selection is None


async def test_y_copies_what_is_known_of_the_selected_bar() -> None:
    async with console() as (app, pilot):
        await press(pilot, "enter", "down", "down", "y")
        first, *facts = app.clipboard.splitlines()
        assert first == "A odom_callback waits"
        assert "  group A held by timer_callback" in facts
        assert "copied A odom_callback waits" in [each.message for each in app._notifications]


@pytest.mark.slow
async def test_y_copies_what_the_moment_means_where_nothing_is_selected() -> None:
    async with console() as (app, pilot):
        await press(pilot, "y")
        assert app.clipboard.splitlines()[:4] == [
            "2 One shared group, t 12.900 s, SingleThreadedExecutor",
            "odom_callback waits 8.9 s: group A is held by timer_callback",
            "  timer_callback runs on MainThread for 8.9 s",
            "  odom_callback waits 8.9 s: group A held by timer_callback",
        ]


@pytest.mark.slow
async def test_lanes_name_the_keys_that_are_in_force() -> None:
    keys = Keymap({"lesson.call_service": ("b",), "lesson.previous_event": ("f7",)})
    app = RecordedConsole("split-groups", split_groups_run().events, 9.4, keys=keys)
    async with app.run_test(size=WIDE) as pilot:
        await settle(pilot)
        assert "▲b" in text_of(app)
        lanes = app.lesson_screen.query_one(Lanes)
        assert lanes.picture is not None
        lanes.selection = Selection(lanes.picture.lanes[0])
        await settle(pilot)
        details = details_of_selection(lanes.timeline, lanes.selection, 0, lanes.keys)
        assert details.facts[-1] == "f7 and } go to what came before and after"
