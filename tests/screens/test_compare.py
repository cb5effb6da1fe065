"""Two runs in the console: one above the other, the same stretch and cursor, and a table of what differs."""

import re
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from functools import partial

import pytest
from textual.pilot import Pilot
from textual.widgets import Static
from textual.widgets._toast import Toast

from cbtui.app import CbtuiApp
from cbtui.keys.action import Scope
from cbtui.keys.actions import ACTIONS, TASKS
from cbtui.keys.config import read_text
from cbtui.keys.keymap import Keymap, keys_of
from cbtui.looks.theme import Charset
from cbtui.runs.compared_runs import ComparedSide
from cbtui.screens import compare
from cbtui.screens.compare import CompareScreen
from cbtui.screens.lesson import LessonScreen
from cbtui.screens.menu import MenuScreen
from cbtui.screens.windows.help import HelpScreen
from cbtui.screens.windows.moment import MomentScreen
from cbtui.widgets.comparison import ComparisonTable
from cbtui.widgets.key_bar import KeyBar
from cbtui.widgets.lanes import Lanes, start_of
from cbtui.widgets.lanes.rows import GroupLane, ThreadLane
from sim.quantities.durations import timestamp
from sim.trace.events import (
    AnyEvent,
    CallbackStarted,
    CommandGiven,
    CommandKind,
    GroupAppeared,
    GroupKind,
    RobotMoved,
    RunEnded,
    ThreadAppeared,
)
from sim.trace.figures.comparison import compare as figures_of
from sim.trace.figures.comparison_sentences import verdict
from sim.trace.model import Window
from sim.trace.timeline import Timeline
from tests.support.builder import ns
from tests.support.console import NARROW, WIDE, RecordedConsole, settle, whole_lanes
from tests.support.exercises import until
from tests.support.pictures import lines_of, text_of
from tests.support.runs import dummy_server_run, shared_group_run, split_groups_run


def timeline_of(events: list[AnyEvent], end: float) -> Timeline:
    """The run up to an end; its calls are those of a node, for none of the person's are compared here."""
    timeline = Timeline()
    timeline.extend([each for each in events if each.t <= ns(end) and not isinstance(each, CommandGiven)])
    return timeline


def sides(ends: tuple[float, float] = (14.0, 9.4)) -> tuple[ComparedSide, ComparedSide]:
    return (
        ComparedSide("shared-group", timeline_of(shared_group_run().events, ends[0]), "/motor_power"),
        ComparedSide("split-groups", timeline_of(split_groups_run().events, ends[1]), "/motor_power"),
    )


class ComparingConsole(CbtuiApp):
    """The console with a comparison open."""

    def __init__(
        self,
        first: ComparedSide,
        second: ComparedSide,
        charset: Charset = Charset.BRAILLE,
        bounds: Window | None = None,
        keys: Keymap | None = None,
    ) -> None:
        super().__init__(charset=charset, keys=keys)
        self.animation_level = "none"
        self.comparison = CompareScreen(first, second, charset, bounds)

    def on_mount(self) -> None:
        self.push_screen(self.comparison)


@asynccontextmanager
async def compared(
    first: ComparedSide, second: ComparedSide, size: tuple[int, int] = WIDE, bounds: Window | None = None
) -> AsyncIterator[tuple[ComparingConsole, Pilot[None]]]:
    app = ComparingConsole(first, second, bounds=bounds)
    async with app.run_test(size=size, notifications=True) as pilot:
        await drawn(app, pilot)
        if bounds is None:
            await press(app, pilot, "0")
        yield app, pilot


async def drawn(app: ComparingConsole, pilot: Pilot[None]) -> None:
    await pilot.pause()
    app.comparison._rest_until = 0.0
    app.comparison.draw()
    await app.workers.wait_for_complete()
    await pilot.pause()
    await whole_lanes(pilot)


async def press(app: ComparingConsole, pilot: Pilot[None], *keys: str) -> None:
    await pilot.press(*keys)
    await drawn(app, pilot)


def lanes(app: ComparingConsole) -> tuple[Lanes, Lanes]:
    first, second = app.comparison.query(Lanes).results(Lanes)
    return first, second


def title(app: ComparingConsole) -> str:
    """What the table says that it is about."""
    return next(line for line in lines_of(app) if line.endswith("──"))


def verdict_of(app: ComparingConsole) -> str:
    return str(app.comparison.query_one("#verdict", Static).content)


async def test_both_runs_have_the_same_stretch_and_cursor_whatever_is_pressed() -> None:
    async with compared(*sides()) as (app, pilot):
        for key in (
            "",
            "left_square_bracket",
            "greater_than_sign",
            "left",
            "right",
            "comma",
            "full_stop",
            "0",
        ):
            if key:
                await press(app, pilot, key)
            first, second = lanes(app)
            assert first.window == second.window
            cursor = app.comparison.navigation.playhead.now(first.timeline.end)
            assert (first.now, second.now) == (cursor, min(cursor, second.timeline.end))
            assert first.picture is not None
            assert second.picture is not None
            assert first.picture.scale == second.picture.scale
            assert first.picture.layout == second.picture.layout


async def test_the_verdict_is_whole_on_a_narrow_screen() -> None:
    async with compared(*sides(), size=NARROW) as (app, _):
        first, second = (side.timeline for side in sides())
        sentence = verdict(figures_of(first, second, Window(0, second.end)))
        assert sentence in " ".join(text_of(app).split())


async def test_it_opens_where_the_runs_first_differ_with_a_verdict() -> None:
    app = ComparingConsole(*sides())
    async with app.run_test(size=WIDE) as pilot:
        await drawn(app, pilot)
        at = app.comparison.navigation.now
        assert 0 < at < lanes(app)[1].timeline.end
        assert f"They differ from {timestamp(at)} on;" in text_of(app)
        assert "run B is better: losses of" in text_of(app)


async def test_the_axis_goes_as_far_as_the_longer_run_and_the_table_as_far_as_the_shorter() -> None:
    async with compared(*sides()) as (app, _):
        assert lanes(app)[0].now == app.comparison._sides[0].timeline.end
        assert "Whole runs, 0 to 9.4 s; run A is 14 s long" in title(app)


@pytest.mark.parametrize(
    "key",
    ["left", "right", "[", "]", "{", "}", ",", ".", "<", ">", "G", "0", "z", "Z", "escape"],
)
def test_a_key_that_moves_through_time_does_the_same_as_in_a_lesson(key: str) -> None:
    here, there = (
        {
            action.id
            for action in ACTIONS
            if action.scope is scope and key in keys_of(action) and not action.refused
        }
        for scope in (Scope.COMPARE, Scope.LESSON)
    )
    assert set() != here <= there


async def test_the_cursor_goes_from_bar_to_bar_of_the_lane_that_was_clicked_on() -> None:
    async with compared(*sides()) as (app, pilot):
        lanes = app.comparison.query_one("#lanes1", Lanes)
        await pilot.click(lanes, offset=(60, 1))
        await pilot.pause()
        assert lanes.selection is not None
        assert app.comparison.query_one("#lanes0", Lanes).selection is None
        await pilot.press("right_curly_bracket")
        later = lanes.now
        await pilot.press("left_curly_bracket", "left_curly_bracket")
        assert lanes.now < later
        assert lanes.selection.bar is not None
        assert start_of(lanes.selection.bar) == lanes.now
        await pilot.press("escape")
        assert lanes.selection is None


def says(app: ComparingConsole, sentence: str) -> bool:
    return sentence in lines_of(app)[0]


async def test_a_key_that_does_nothing_says_why_at_the_top_and_covers_no_figure() -> None:
    async with compared(*sides(), size=NARROW) as (app, pilot):
        for other in ("s", "x"):
            await pilot.press(other)
            await until(pilot, lambda: bool(app.screen.query(Toast)))
        for key, sentence in (
            ("enter", "Code is shown beside a run"),
            ("full_stop", "This is the end"),
            ("d", "Diagnoses are listed in a run"),
            ("right", "This is the end"),
            ("right_curly_bracket", "No bar is later"),
            ("P", "P, predict, works in a run, not in a comparison."),
            ("space", "␣, pause, works in a run"),
            ("plus", "+, speed, works in a run"),
            ("1", "1, pane, works in a run"),
            ("tab", "tab, next pane, works in a run"),
            ("ctrl+r", "^r, start over, works in a run"),
        ):
            assert not says(app, sentence)
            await pilot.press(key)
            await until(pilot, partial(says, app, sentence))
            assert "run A  shared-group" in text_of(app)


async def test_a_key_that_was_moved_says_by_its_new_place_that_it_is_for_a_run() -> None:
    config, _ = read_text('[keys]\nlesson.predict = "f9"\nlesson.faster = "w"', "config.toml")
    app = ComparingConsole(*sides(), keys=config.keymap)
    async with app.run_test(size=NARROW, notifications=True) as pilot:
        await drawn(app, pilot)
        await press(app, pilot, "w", "P")
        assert "works in a run" not in text_of(app)
        await pilot.press("f9", "s")
        await until(pilot, lambda: "s, service, works in a run" in text_of(app))
        assert [each.message.partition(",")[0] for each in app._notifications] == ["s"], (
            "one covers no verdict"
        )
        await pilot.press("f9")
        await until(pilot, lambda: "f9, predict, works in a run" in text_of(app))


async def test_a_sentence_about_the_screen_before_is_taken_away() -> None:
    app = ComparingConsole(*sides())
    async with app.run_test(size=NARROW, notifications=True) as pilot:
        await drawn(app, pilot)
        app.notify("node.py was saved: it runs again.")
        await until(pilot, lambda: "was saved" in text_of(app))
        app.push_screen(CompareScreen(*sides(), app.charset))
        await until(pilot, lambda: "was saved" not in text_of(app))
        await app.workers.wait_for_complete()


async def test_w_lets_the_table_tell_of_the_stretch_on_screen_and_back() -> None:
    async with compared(*sides()) as (app, pilot):
        await press(app, pilot, "w")
        assert "On screen, 4 to 9.4 s; run B ends at" in title(app)
        await press(app, pilot, "greater_than_sign")
        assert "On screen, 9 to 9.4 s" in title(app)
        await press(app, pilot, "w")
        assert "Whole runs, 0 to 9.4 s" in title(app)


async def test_the_end_of_a_run_is_told_whole_where_its_executor_has_no_room() -> None:
    async with compared(*sides((14.0, 3.0)), size=NARROW) as (app, _):
        headings = [line.rstrip() for line in lines_of(app) if re.match(" run [AB]  ", line)][:2]
        for line in headings:
            assert re.search(r"   (?:ends at \d+\.000 s|goes on)(?: {3}|$)", line), line
            assert "…" not in line


async def test_what_a_run_lost_up_to_its_end_is_told_beside_that_end_wherever_the_cursor_is() -> None:
    async with compared(*sides()) as (app, pilot):
        lost = lanes(app)[0].timeline.dropped(ns(14.0))
        assert f"ends at 14.000 s   lost {lost}   " in text_of(app)
        await press(app, pilot, "G", *["backspace"] * 8, "1", "enter")
        assert f"ends at 14.000 s   lost {lost}   " in text_of(app)


async def test_a_stretch_that_only_one_run_has_says_so() -> None:
    async with compared(*sides((14.0, 3.0))) as (app, pilot):
        await press(app, pilot, "w")
        assert "On screen: nothing that both runs have; run B ends at 3.000 s" in text_of(app)
        assert "odom_callback" not in "\n".join(lines_of(app)[-18:])


async def test_at_the_beginning_no_key_is_said_to_look_back() -> None:
    async with compared(*sides(), size=(160, 40)) as (app, pilot):
        await press(app, pilot, "G", "0", "enter")
        assert "] cursor" in lines_of(app)[-1]
        assert "look back" not in lines_of(app)[-1]


async def test_g_goes_to_a_moment_of_both() -> None:
    async with compared(*sides()) as (app, pilot):
        await pilot.press("G")
        assert isinstance(app.screen, MomentScreen)
        await press(app, pilot, *["backspace"] * 8, *"5.5", "enter")
        assert [each.now for each in lanes(app)] == [ns(5.5)] * 2
        assert "t 5.500 s" in lines_of(app)[0]


async def test_steps_stop_at_the_events_of_either_run() -> None:
    async with compared(*sides()) as (app, pilot):
        await press(app, pilot, "left_square_bracket", "left_square_bracket", "left_square_bracket")
        await press(app, pilot, "left_square_bracket", "left_square_bracket", "left_square_bracket")
        at = lanes(app)[0].now
        timelines = [side.timeline for side in app.comparison._sides]
        beside = [timeline.neighbour(at, -1) for timeline in timelines]
        await press(app, pilot, "comma")
        assert lanes(app)[0].now == max(each for each in beside if each is not None)
        at = lanes(app)[0].now
        beside = [timeline.neighbour(at, 1) for timeline in timelines]
        await press(app, pilot, "full_stop")
        assert lanes(app)[0].now == min(each for each in beside if each is not None)


async def test_a_narrow_screen_scrolls_the_table_and_z_lets_it_fill_the_screen() -> None:
    async with compared(*sides(), size=NARROW) as (app, pilot):
        table = app.comparison.query_one(ComparisonTable)
        assert "run A  shared-group" in text_of(app)
        assert "run B  split-groups" in text_of(app)
        assert "whole program" not in text_of(app)
        await press(app, pilot, *["down"] * 12)
        assert table.scroll_offset.y > 0
        assert "heading" in text_of(app)
        before = table.size.height
        down = table.scroll_offset.y
        await press(app, pilot, "pageup")
        assert table.scroll_offset.y == max(0, down - before)
        await press(app, pilot, "pagedown")
        assert table.scroll_offset.y == min(table.max_scroll_y, max(0, down - before) + before)
        await press(app, pilot, *["up"] * 12, "z")
        assert table.scroll_offset.y == 0
        assert table.size.height > before + 6
        await press(app, pilot, "z")
        assert table.size.height == before


async def test_of_runs_in_which_the_service_was_not_called_alike_none_is_called_better() -> None:
    first, second = sides()
    second.timeline.extend([CommandGiven(ns(9.4), "call /motor_power true", CommandKind.CALL)])
    async with compared(first, second) as (app, _):
        assert "run B is better" in verdict_of(app)
    first, second = sides()
    second.timeline.extend([CommandGiven(ns(7.0), "call /motor_power true", CommandKind.CALL)])
    async with compared(first, second) as (app, _):
        assert "run A has no 'call /motor_power true', run B has 1: only with as many" in verdict_of(app)
        assert "cbtui compare --call SECONDS gives both the same" in verdict_of(app)
        assert "Gone" not in verdict_of(app)


async def test_of_runs_that_share_no_callback_none_is_called_better_nor_a_first_difference_named() -> None:
    other = ComparedSide("other", timeline_of(dummy_server_run().events, 9.4))
    async with compared(sides()[0], other) as (app, _):
        told = "The runs share only timer_callback of 4 callbacks: too little in common for one to be better"
        assert verdict_of(app) == f"Found in run A: wait for a group. {told}"


@pytest.mark.parametrize("size", [NARROW, (80, 28)])
async def test_both_runs_show_the_same_lanes(size: tuple[int, int]) -> None:
    async with compared(*sides(), size=size) as (app, _):
        first, second = app.comparison.query(Lanes)
        assert first.size == second.size
        assert first.kept
        names, others = (
            {each.timeline.entities[kept].label: rank for kept, rank in each.kept.items()}
            for each in lanes(app)
        )
        assert names == others


async def test_the_same_group_has_the_same_letter_and_colour_in_both_runs() -> None:
    head, *events = shared_group_run().events
    more = GroupAppeared(0, 90, 1, GroupKind.EXCLUSIVE, "MutuallyExclusiveCallbackGroup")
    second = ComparedSide("one more group", timeline_of([head, more, *events], 14.0), "/motor_power")
    async with compared(sides((14.0, 14.0))[0], second) as (app, _):
        names = [
            [
                row[0]
                for row, lane in zip(each.picture.rows, each.picture.lanes, strict=False)
                if isinstance(lane, GroupLane)
            ]
            for each in lanes(app)
            if each.picture
        ]
        assert names[0] == names[1] != []


@pytest.mark.parametrize("size", [NARROW, WIDE])
async def test_a_callback_is_at_the_same_height_in_both_runs_however_many_threads_they_have(
    size: tuple[int, int],
) -> None:
    first, _ = sides()
    head, *events = shared_group_run().events
    threads = [ThreadAppeared(0, 90 + number, f"worker {number}") for number in range(3)]
    second = ComparedSide("more threads", timeline_of([head, *threads, *events], 14.0), "/motor_power")
    async with compared(first, second, size=size) as (app, _):
        pictures = [each.picture for each in lanes(app)]
        rows = [
            [lane for lane in each.lanes if not isinstance(lane, ThreadLane)] for each in pictures if each
        ]
        assert rows[0]
        assert [each.lanes[: len(rows[0])] for each in pictures if each] == [tuple(rows[0])] * 2


async def test_a_narrow_screen_names_the_key_that_lets_all_lanes_be_seen() -> None:
    async with compared(*sides(), size=NARROW) as (app, pilot):
        table = app.comparison.query_one(ComparisonTable)
        assert "+3 lanes Z" in text_of(app)
        await press(app, pilot, "Z")
        assert "lanes" not in text_of(app)
        assert "ThreadPoolExecutor-0_3" in text_of(app) or "Pool-0_3" in text_of(app)
        shown = [table.display]
        await press(app, pilot, "z")
        shown.append(table.display)
        assert shown == [False, True]
        assert not app.comparison.query_one("#lanes0").display
        await press(app, pilot, "z")
        assert "+3 lanes Z" in text_of(app)


async def test_lanes_alone_have_what_a_long_verdict_leaves_of_a_narrow_screen() -> None:
    async with compared(*sides(), size=NARROW) as (app, pilot):
        verdict = app.comparison.query_one("#verdict", Static)
        await press(app, pilot, "Z")
        verdict.update("a long verdict " * 15)
        await pilot.pause()
        assert verdict.size.height == 3
        first, second = lanes(app)
        assert min(first.size.height, second.size.height) >= 8
        assert second.region.bottom == app.comparison.query_one(KeyBar).region.y == NARROW[1] - 1


async def test_a_wide_screen_has_room_for_everything() -> None:
    async with compared(*sides((9.4, 9.4))) as (app, _):
        table = app.comparison.query_one(ComparisonTable)
        assert table.max_scroll_y == 0
        picture = text_of(app)
        for word in ("calls", "lost", "wait med/max", "age med/max", "robot travelled", "collisions"):
            assert word in picture


@pytest.mark.parametrize("key", ["up", "down", "pageup", "pagedown"])
async def test_a_table_that_is_whole_on_screen_says_so_instead_of_scrolling(key: str) -> None:
    async with compared(*sides((9.4, 9.4))) as (app, pilot):
        await until(pilot, lambda: "scroll" not in lines_of(app)[-1])
        await pilot.press(key)
        await until(pilot, lambda: "There are no more rows to scroll to." in lines_of(app)[0])


async def test_what_is_asked_for_is_what_the_table_and_the_lanes_begin_with() -> None:
    async with compared(*sides(), bounds=Window(ns(2.0), ns(5.0))) as (app, _):
        assert "As asked, 2 to 5 s; run A is 14 s long; run B is 9.4 s long" in title(app)
        shown = lanes(app)[0].window
        assert shown.start <= ns(2.0)
        assert shown.end >= ns(5.0)


async def test_a_run_that_goes_on_grows_on_screen_and_in_the_table() -> None:
    events = shared_group_run().events
    growing = Timeline()
    growing.extend([event for event in events if event.t <= ns(3.0)])
    first = ComparedSide("now", growing, alive=lambda: True)
    async with compared(first, sides()[1]) as (app, pilot):
        await press(app, pilot, "less_than_sign")
        assert "goes on" in text_of(app)
        assert lanes(app)[0].now == growing.end
        assert "Whole runs, 0 to 3 s" in title(app)
        growing.extend([event for event in events if ns(3.0) < event.t <= ns(6.0)])
        await drawn(app, pilot)
        assert [each.now for each in lanes(app)] == [growing.end] * 2
        assert "Whole runs, 0 to 6 s" in title(app)


async def test_a_problem_of_a_run_that_ended_early_is_gone_once_the_other_run_has_gone_on() -> None:
    events = split_groups_run().events
    growing = Timeline()
    growing.extend([event for event in events if event.t <= ns(3.0)])
    failed = Timeline()
    begun = [event for event in shared_group_run().events if event.t <= ns(2.0)]
    failed.extend([*begun, RunEnded(ns(2.0), "it raised", failed=True, problem="it raised")])
    now = ComparedSide("now", growing, alive=lambda: True)
    async with compared(ComparedSide("failed", failed), now) as (app, pilot):
        assert "Gone in run B" not in text_of(app)
        growing.extend([event for event in events if ns(3.0) < event.t <= ns(6.0)])
        await until(pilot, lambda: "Gone in run B: exception." in text_of(app))


async def test_a_run_that_an_exception_ended_early_is_not_judged_by_what_came_before() -> None:
    events = shared_group_run().events
    failed, growing = Timeline(), Timeline()
    failed.extend(
        [*(each for each in events if each.t < ns(0.3)), RunEnded(ns(0.3), "it raised", failed=True)]
    )
    growing.extend([event for event in events if event.t <= ns(6.0)])
    now = ComparedSide("now", growing, alive=lambda: True)
    async with compared(ComparedSide("failed", failed), now) as (app, pilot):
        assert "Run A ended at 0.3 s with an exception; run B has none up to 6 s" in text_of(app)
        growing.extend([RunEnded(ns(7.0), "it raised too", failed=True)])
        await until(pilot, lambda: "with an exception, and run B at 7 s with one" in text_of(app))
        assert "is better" not in text_of(app)
        assert "What both runs have, 0 to 0.3 s; run B is" in title(app)


async def test_the_cursor_is_where_the_shorter_run_ended_with_an_exception_if_nothing_differs_before() -> (
    None
):
    events = shared_group_run().events
    failed = Timeline()
    failed.extend([*(each for each in events if each.t < ns(0.3)), RunEnded(ns(0.3), "x", failed=True)])
    app = ComparingConsole(ComparedSide("failed", failed), ComparedSide("b", timeline_of(events, 6.0)))
    async with app.run_test(size=WIDE) as pilot:
        await drawn(app, pilot)
        assert app.comparison.navigation.now == failed.end


async def test_verdict_and_table_are_about_the_same_span() -> None:
    async with compared(*sides()) as (app, pilot):
        assert "; in 0 to 9.4 s run B is better" in verdict_of(app)
        await press(app, pilot, "greater_than_sign", "w")
        assert verdict_of(app).startswith("On screen, 9 to 9.4 s: they differ from")
        await press(app, pilot, "w")
        assert "; in 0 to 9.4 s run B is better" in verdict_of(app)


async def test_of_runs_of_one_length_the_verdict_names_no_span() -> None:
    async with compared(*sides((9.4, 9.4))) as (app, _):
        assert "; run B is better" in verdict_of(app)


async def test_a_run_that_has_only_begun_gets_its_verdict_and_the_first_difference_later() -> None:
    growing = Timeline()
    app = ComparingConsole(sides()[0], ComparedSide("now", growing, alive=lambda: True))
    async with app.run_test(size=WIDE) as pilot:
        await drawn(app, pilot)
        assert "No call differs" not in text_of(app)
        growing.extend([event for event in split_groups_run().events if event.t <= ns(9.4)])
        await drawn(app, pilot)
        at = app.comparison.navigation.now
        assert 0 < at < growing.end
        assert f"They differ from {timestamp(at)} on;" in text_of(app)
        await press(app, pilot, "0")
        assert app.comparison.navigation.now == growing.end


async def test_a_run_in_which_no_callback_has_run_yet_has_no_figures() -> None:
    events = shared_group_run().events
    first_call = min(each.t for each in events if isinstance(each, CallbackStarted))
    growing = Timeline()
    growing.extend([each for each in events if each.t < first_call])
    app = ComparingConsole(sides()[0], ComparedSide("now", growing, alive=lambda: True))
    async with app.run_test(size=WIDE) as pilot:
        await drawn(app, pilot)
        begun = f"Whole runs: no callback has run yet in run B, which has come to {timestamp(growing.end)}"
        assert begun in title(app)
        assert "calls" not in text_of(app)
        growing.extend([each for each in events if first_call <= each.t <= ns(3.0)])
        await until(pilot, lambda: "Whole runs, 0 to 3 s" in title(app))
        assert "calls" in text_of(app)


async def test_how_a_run_failed_and_what_of_a_recording_is_lost_is_said() -> None:
    failed, long = Timeline(), Timeline()
    for timeline, reason in ((failed, "it broke"), (long, " ".join(["it broke"] * 20))):
        moved = RobotMoved(0, 0, 0, 0, 1, 0, 0, True, False, 0, 0)
        timeline.extend([moved, RunEnded(ns(1), reason, failed=True)])
    async with compared(
        ComparedSide("a", failed), ComparedSide("b", sides()[1].timeline, damage="it breaks off")
    ) as (
        app,
        _,
    ):
        told = {notification.message for notification in app._notifications}
        assert told == {"it breaks off"}, "how the run failed stands above it, where it covers no verdict"
        assert "run A  a   ends at 1.000 s   it broke   lost 0" in text_of(app)
    async with compared(ComparedSide("a", long), sides()[1], size=NARROW) as (app, _):
        assert re.search(r"run A  a   ends at 1.000 s   it broke it broke [^\n]*…   lost 0", text_of(app))


@pytest.mark.slow
async def test_help_begins_with_the_comparisons_keys_and_q_is_the_way_back() -> None:
    async with compared(*sides(), size=NARROW) as (app, pilot):
        await pilot.press("question_mark")
        assert isinstance(app.screen, HelpScreen)
        rows = str(app.screen.query_one("#found", Static).render()).splitlines()
        assert {"Comparison", *(f"In a run: {task}" for task in TASKS)} <= set(rows)
        assert not set(TASKS) & set(rows)
        signs = {row.split()[0] for row in rows if row.split()}
        assert {"(P)", "(s)", "(t)", "(N)", "(x)", "(C)"} <= signs, "nothing can be done with them here"
        assert {"(G)", "(Z)", "(w)"} & signs == {"(w)"}, "which is one thing in a run and another here"
        await pilot.press("slash", *"table cover")
        await pilot.pause()
        assert "Let the table cover whole runs, or only what is on screen" in text_of(app)
        await pilot.press("escape", "escape", "q")
        assert isinstance(app.screen, MenuScreen)


async def test_too_small_a_terminal_gets_a_sentence() -> None:
    async with compared(*sides(), size=(60, 20)) as (app, pilot):
        assert "cbtui needs a terminal of 80 columns" in text_of(app)
        await pilot.resize_terminal(*WIDE)
        await drawn(app, pilot)
        await until(pilot, lambda: "run A  shared-group" in text_of(app))


async def test_a_lesson_offers_a_comparison_once_there_is_a_run_before() -> None:
    app = RecordedConsole("shared-group", shared_group_run().events, 13.15)
    async with app.run_test(size=WIDE) as pilot:
        await settle(pilot)
        assert app.lesson_screen.check_action("compare", ()) is False
        before = app.lesson_screen.runs.run.timeline
        await pilot.press("t", "4")
        await settle(pilot)
        assert app.lesson_screen.check_action("compare", ()) is True
        lesson = app.lesson_screen
        await pilot.press("C")
        await until(pilot, lambda: isinstance(app.screen, CompareScreen))
        comparison = app.screen
        assert isinstance(comparison, CompareScreen)
        first, second = comparison._sides
        assert (first.name, second.name) == ("shared-group, as written", "shared-group, 4 threads")
        assert first.timeline is before
        assert second.timeline is lesson.runs.run.timeline
        assert (first.alive(), second.alive()) == (False, True)
        app.engines.latest.play(ns(15))
        await until(pilot, lambda: lesson.runs.run.timeline.end > ns(14))
        comparison.draw()
        assert comparison.query(Lanes).last(Lanes).now == lesson.runs.run.timeline.end > ns(14)
        await pilot.press("q")
        assert isinstance(app.screen, LessonScreen)


async def test_keys_are_answered_while_a_comparison_goes_on(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compare, "_TIME_SLICE", 0.0)
    monkeypatch.setattr(compare, "_PROGRESS_AFTER", 0.0)
    monkeypatch.setattr(compare, "_YIELD_TIME", 0.5)
    app = ComparingConsole(*sides())
    async with app.run_test(size=WIDE) as pilot:
        await pilot.pause()
        app.comparison.draw()
        before = app.comparison.navigation.playhead
        await pilot.press("left_square_bracket")
        assert app.comparison.navigation.playhead != before
        assert re.search(r"Comparing, \d+ s so far", text_of(app))
        assert app.comparison._comparing
        monkeypatch.setattr(compare, "_TIME_SLICE", 10.0)
        await app.workers.wait_for_complete()
        await pilot.pause()
        assert "Whole runs, 0 to 9.4 s" in title(app)


async def test_asking_for_something_else_ends_a_comparison_that_goes_on(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(compare, "_TIME_SLICE", 0.0)
    monkeypatch.setattr(compare, "_YIELD_TIME", 0.05)
    app = ComparingConsole(*sides())
    async with app.run_test(size=WIDE) as pilot:
        await pilot.pause()
        app.comparison.draw()
        assert app.comparison._comparing
        monkeypatch.setattr(compare, "_TIME_SLICE", 10.0)
        await press(app, pilot, "w")
        assert title(app).strip().startswith("On screen")
