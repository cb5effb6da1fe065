"""The keys that stop time, step it, and go to a moment."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import pytest
from msgspec.structs import replace
from textual.pilot import Pilot
from textual.widgets import Static

from cbtui.app import CbtuiApp
from cbtui.screens.windows.moment import MomentScreen, seconds_in
from cbtui.widgets.code import CodeView
from cbtui.widgets.lanes import Lanes
from cbtui.widgets.narrator.narrator import Narrator
from sim.engine.commands import Pause, RunUntil, SetSpeed, Step
from sim.trace.events import TimeHalted
from sim.trace.model import Window
from tests.support.builder import Run, ns
from tests.support.console import NARROW, WIDE, RecordedConsole, settle
from tests.support.fake_session import FakeEngines
from tests.support.pictures import lines_of, text_of
from tests.support.runs import dummy_server_run, shared_group_run


@asynccontextmanager
async def console() -> AsyncIterator[tuple[RecordedConsole, Pilot[None]]]:
    """A console on a lesson, 13.15 s into its run."""
    app = RecordedConsole("shared-group", shared_group_run().events, 13.15)
    async with app.run_test(size=WIDE) as pilot:
        await settle(pilot)
        yield app, pilot


async def press(pilot: Pilot[None], *keys: str) -> None:
    await pilot.press(*keys)
    await settle(pilot)


def status(app: CbtuiApp) -> str:
    return lines_of(app)[0]


async def test_a_step_is_offered_in_a_pause_and_reaches_the_engine() -> None:
    async with console() as (app, pilot):
        assert ". step" not in lines_of(app)[-1]
        await press(pilot, "full_stop")
        assert app.engines.latest.commands == []
        await press(pilot, "space")
        assert ". step" in lines_of(app)[-1]
        await press(pilot, "full_stop", "full_stop")
        assert app.engines.latest.commands == [Pause(), Step(), Step()]
        assert "PAUSED" in status(app)


async def test_who_looks_back_in_a_pause_follows_the_run_again_when_it_goes_on() -> None:
    async with console() as (app, pilot):
        await press(pilot, "space", "left_square_bracket")
        assert "BACK" in status(app)
        await press(pilot, "space")
        app.engines.latest.play(ns(14.5))
        await settle(pilot)
        assert "LIVE" in status(app)
        assert app.lesson_screen.query_one(Lanes).now == ns(14.5)


async def test_a_comma_looks_back_by_one_event_and_a_full_stop_forward_until_live_again() -> None:
    async with console() as (app, pilot):
        timeline = app.lesson_screen.runs.run.timeline
        before = timeline.neighbour(timeline.end, -1)
        assert before is not None
        await press(pilot, "comma")
        assert f"t {before / 1e9:.3f} s" in status(app)
        assert "BACK" in status(app)
        await press(pilot, "comma", "full_stop")
        assert f"t {before / 1e9:.3f} s" in status(app)
        await press(pilot, "full_stop")
        assert "LIVE" in status(app)
        assert app.engines.latest.commands == []


async def test_the_code_goes_to_the_callback_of_the_last_decision_of_a_step() -> None:
    async with console() as (app, pilot):
        await press(pilot, "space", "full_stop")
        step = app.screen.query_one(CodeView).step
        timeline = app.lesson_screen.runs.run.timeline
        assert step is None, "nothing was decided at the moment"
        await press(pilot, "comma")
        step = app.screen.query_one(CodeView).step
        assert step is not None
        decided = [what for _, what in timeline.decisions(Window(step.at, step.at + 1))]
        what = decided[step.place]
        assert step.about == (what if isinstance(what, int) else what.entity)
        await press(pilot, "0", "space")
        assert app.screen.query_one(CodeView).step is None, "time flows"


async def test_the_lane_of_the_callback_that_a_step_is_about_is_among_the_last_to_be_hidden() -> None:
    async with console() as (app, pilot):
        lanes = app.screen.query_one(Lanes)
        await press(pilot, "space", "comma")
        step = app.screen.query_one(CodeView).step
        assert step is not None
        assert [*lanes.kept] == [step.about]
        app.lesson_screen.navigation.seek(ns(2.0))
        await press(pilot, "comma")
        assert lanes.kept_thread in app.lesson_screen.runs.timeline.threads, "one ran a callback then"
        decided = lanes.kept, lanes.kept_thread
        app.lesson_screen.navigation.seek(app.lesson_screen.navigation.now + 1)  # the narrator still tells it
        await settle(pilot)
        assert (lanes.kept, lanes.kept_thread) == decided
        assert app.screen.query_one(CodeView).step is None
        await press(pilot, "0", "space")
        assert not lanes.kept, "time flows"
        assert lanes.kept_thread is None


async def test_a_step_on_the_real_clock_says_why_there_is_none() -> None:
    async with console() as (app, pilot):
        run = app.lesson_screen.runs.run
        run.setup = replace(run.setup, clock="real")
        for keys in (["full_stop"], ["space", "full_stop"]):
            await press(pilot, *keys)
            assert [note.message for note in app._notifications][-1] == (
                "On the real clock nobody knows the next event: steps need virtual time; "
                ", looks back, event by event."
            )


@pytest.mark.parametrize(("key", "stays"), [("comma", False), ("N", True)])
async def test_a_narrator_that_came_with_a_step_goes_when_the_run_goes_on_live(key: str, stays: bool) -> None:
    async with console() as (app, pilot):
        narrator = app.screen.query_one(Narrator)
        await press(pilot, key, "comma")
        assert narrator.display
        await press(pilot, "0")
        assert narrator.display == stays
        await press(pilot, "space", "full_stop")
        assert narrator.display
        await press(pilot, "space")
        assert narrator.display == stays


async def test_a_key_that_leads_no_further_says_so() -> None:
    async with console() as (app, pilot):
        for keys, said in (
            (["comma"], "This is the beginning: no event is before it."),
            (["left_square_bracket"], "This is the beginning."),
            (["left_curly_bracket"], "There is no earlier bar here."),
            (["0", "right_square_bracket"], "The end is on screen already."),
            (["0", "right_curly_bracket"], "There is no later bar here."),
            (["greater_than_sign"] * 20, "No shorter stretch can be shown."),
            (["less_than_sign"] * 20, "No longer stretch can be shown."),
        ):
            app.lesson_screen.navigation.seek(0)
            await press(pilot, *keys)
            assert [note.message for note in app._notifications][-1] == said


@pytest.mark.parametrize(
    ("key", "which"), [("left_curly_bracket", "earlier"), ("right_curly_bracket", "later")]
)
async def test_where_no_lane_has_a_bar_the_way_to_one_says_so(key: str, which: str) -> None:
    run = Run()
    run.timer(run.exclusive(run.node("/n")), "tick", 1.0)
    run.log("later", 3.0)
    app = RecordedConsole("shared-group", run.events, 3.0)
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        app.lesson_screen.navigation.seek(ns(1.0))
        await press(pilot, key)
        assert [note.message for note in app._notifications] == [f"There is no {which} bar here."]


async def test_without_a_selection_the_way_to_a_bar_leads_to_the_nearest_lane_that_has_one() -> None:
    run = Run()
    first, second = run.thread("one"), run.thread("two")
    a, b = (run.timer(run.exclusive(run.node(f"/n{name}")), name, 1.0) for name in "ab")
    run.callback(a, first, 1.0, 2.0)
    run.callback(b, second, 4.0, 5.0)
    run.log("later", 8.0)
    app = RecordedConsole("shared-group", run.events, 8.0)
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        app.lesson_screen.navigation.seek(ns(1.5))
        await press(pilot, "right_curly_bracket")
        assert app.lesson_screen.navigation.now == ns(4.0)
        await press(pilot, "right_curly_bracket")  # now its lane is selected, and has no other one
        assert [note.message for note in app._notifications] == ["There is no later bar here."]


async def test_why_a_key_does_nothing_is_said_no_longer_than_it_is_so() -> None:
    async with console() as (app, pilot):
        await press(pilot, "u", "0")
        assert [note.message for note in app._notifications] == ["The present is on screen already."]
        await press(pilot, "left_square_bracket")
        assert "BACK" in lines_of(app)[0]
        assert not list(app._notifications)


@pytest.mark.parametrize(("rows", "narrated"), [(40, 4), (60, 6)])
async def test_a_wide_narrator_grows_where_a_moment_needs_more_rows_and_the_panes_have_room(
    rows: int, narrated: int
) -> None:
    run = Run()
    group, thread = run.exclusive(run.node("/n")), run.thread("MainThread")
    for number in range(5):
        run.callback(run.timer(group, f"tick_{number}", 1.0), thread, 1.0, 0.0)
    run.log("later", 3.0)
    app = RecordedConsole("shared-group", run.events, 3.0)
    async with app.run_test(size=(140, rows)) as pilot:
        await settle(pilot)
        await press(pilot, "comma")
        narrator = app.screen.query_one(Narrator)
        await press(pilot, "comma")
        assert narrator.outer_size.height == narrated
        assert narrator.place == 3
        await press(pilot, *["comma"] * 4)
        assert narrator.now == 0


async def test_a_narrow_narrator_takes_its_rows_from_the_lanes_and_gives_them_back() -> None:
    app = RecordedConsole("shared-group", shared_group_run().events, 13.15)
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)

        def heights() -> list[int]:
            return [app.screen.query_one(each).outer_size.height for each in (Lanes, Narrator, "#panes")]

        before = heights()
        await press(pilot, "N")
        assert heights() == [6, 4, 10]
        await press(pilot, "N")
        assert heights()[::2] == before[::2]


async def test_going_to_a_moment_that_has_passed_looks_back() -> None:
    async with console() as (app, pilot):
        await press(pilot, "G")
        assert isinstance(app.screen, MomentScreen)
        await press(pilot, *"3,5", "enter")
        assert "t 3.500 s" in status(app)
        assert app.engines.latest.commands == []


@pytest.mark.slow
async def test_going_to_a_moment_to_come_lets_the_run_go_on_until_then() -> None:
    async with console() as (app, pilot):
        await press(pilot, "space", "left_square_bracket", "G", *"14.5", "enter")
        assert app.engines.latest.commands == [Pause(), RunUntil(ns(14.5))]
        assert "LIVE" in status(app)
        app.lesson_screen.runs.run.take([TimeHalted(ns(14.5), "run until 14.5 s")])
        app.lesson_screen.draw()
        await settle(pilot)
        assert "PAUSED" in status(app)
        assert "t 14.500 s" in status(app)


@pytest.mark.slow
async def test_what_is_no_moment_is_asked_for_again_and_escape_stays() -> None:
    async with console() as (app, pilot):
        await press(pilot, "G", *"soon", "enter")
        assert isinstance(app.screen, MomentScreen)
        assert "Give the seconds as a number" in str(app.screen.query_one("#wrong", Static).render())
        await press(pilot, "escape")
        assert "LIVE" in status(app)
        assert app.lesson_screen.runs.run.alive


@pytest.mark.slow
async def test_a_moment_past_the_end_of_a_run_that_is_over_is_its_end() -> None:
    async with console() as (app, pilot):
        app.engines.latest.end("gone")
        await settle(pilot)
        await press(pilot, "left_square_bracket", "G", *"99", "enter")
        assert app.engines.latest.commands == []
        assert "t 13.150 s" in status(app)


@pytest.mark.parametrize(
    ("text", "seconds"),
    [("12.5", 12.5), (" 3 s ", 3.0), ("0,25", 0.25), ("-1", None), ("nan", None), ("x", None)],
)
def test_seconds_are_read_as_people_type_them(text: str, seconds: float | None) -> None:
    assert seconds_in(text) == seconds


@pytest.mark.slow
async def test_on_the_real_clock_a_pause_says_that_computing_goes_on(tmp_path: Path) -> None:
    file = tmp_path / "my_node.py"
    file.write_text("")
    engines = FakeEngines(dummy_server_run().events, ns(2.0))
    app = CbtuiApp(start_file=(file, [], "real"), open_session=engines)
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        assert "real ×1.0" in status(app)
        await press(pilot, "plus", "space")
        assert "PAUSED  real: computing goes on" in status(app)
        assert engines.latest.commands == [SetSpeed(2.0), Pause()]
        assert ". step" not in text_of(app)
