"""Changing the set-up at the keyboard: threads, groups, periods and numbers, and what becomes of the runs."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import pytest
from textual.pilot import Pilot
from textual.widgets import OptionList
from textual.widgets._toast import Toast

from cbtui.app import CbtuiApp
from cbtui.runs.setup.changes import Changes
from cbtui.screens.lesson import LessonScreen
from cbtui.screens.windows.group import GroupScreen
from cbtui.screens.windows.setup import SetupScreen
from cbtui.screens.windows.value import ValueScreen
from cbtui.widgets.diagnosis_line import DiagnosisLine
from cbtui.widgets.key_bar import KeyBar
from sim.engine.setup import GroupChange, PeriodChange, RealRos
from sim.trace.events import AnyEvent, CommandGiven, CommandKind
from tests.support.console import NARROW, WIDE, RecordedConsole, predict, settle
from tests.support.daily import first_daily, first_row_daily
from tests.support.fake_session import FakeEngines, FakeSession
from tests.support.pictures import lines_of, text_of
from tests.support.runs import Run, dummy_server_run, ns, shared_group_run

ODOM_OWN = GroupChange("/sub_node", "odom_callback", "own")
TO_ODOM = ("enter", "down", "down")
"""Keys that select odom_callback on the lanes."""
_PATIENCE = 60.0


@asynccontextmanager
async def console(
    size: tuple[int, int] = NARROW,
    lesson: str = "shared-group",
    events: list[AnyEvent] | None = None,
    seconds: float = 12.9,
) -> AsyncIterator[tuple[RecordedConsole, Pilot[None]]]:
    """A console on a lesson, in its run."""
    app = RecordedConsole(lesson, shared_group_run().events if events is None else events, seconds)
    async with app.run_test(size=size, notifications=True) as pilot:
        await settle(pilot)
        yield app, pilot


async def press(pilot: Pilot[None], *keys: str) -> None:
    await pilot.press(*keys)
    await pilot.pause()
    await settle(pilot)


def sessions(app: RecordedConsole) -> list[FakeSession]:
    """Those of the lesson on screen; the menu may have one of its own."""
    title = app.lesson_screen.runs.run.setup.title
    return [session for session in app.engines.sessions if session.setup.title == title]


def notes(app: CbtuiApp) -> list[str]:
    return [note.message for note in app._notifications]


# groups


async def test_g_gives_the_selected_callback_another_group_and_keeps_the_run_before() -> None:
    async with console() as (app, pilot):
        before = app.lesson_screen.runs.run
        await press(pilot, *TO_ODOM, "g")
        assert isinstance(app.screen, GroupScreen)
        assert "Which callback group should odom_callback have?" in text_of(app)
        assert "In this run: group A exclusive, with scan, timer." in text_of(app)
        await press(pilot, "o")
        assert app.lesson_screen.runs.run.setup.groups == (ODOM_OWN,)
        assert [session.stopped for session in sessions(app)] == [True, False]
        kept = app.lesson_screen.restarts.before
        assert kept is not None
        assert kept.timeline is before.timeline
        assert kept.name == "shared-group, as written"
        assert notes(app) == [
            "self.odom_group = MutuallyExclusiveCallbackGroup()\n"
            "self.create_subscription(…, self.odom_callback, …,\n    callback_group=self.odom_group)"
        ]


@pytest.mark.parametrize(
    ("key", "code"),
    first_row_daily(
        ("o", "self.odom_group = MutuallyExclusiveCallbackGroup()"),
        ("s", "self.shared_group = MutuallyExclusiveCallbackGroup()"),
        ("r", "self.reentrant_group = ReentrantCallbackGroup()"),
        ("d", "self.odom_callback, …)  # no group named"),
    ),
)
async def test_each_group_shows_its_code_and_has_its_key(key: str, code: str) -> None:
    wishes = {"o": "own", "s": "shared", "r": "reentrant", "d": "default"}
    async with console() as (app, pilot):
        await press(pilot, *TO_ODOM, "g", "home", *["down"] * list(wishes).index(key))
        assert code in text_of(app)
        await press(pilot, key)
        (change,) = app.lesson_screen.runs.run.setup.groups
        assert change.wish == wishes[key]


@pytest.mark.slow
async def test_the_group_in_force_is_highlighted_and_p_gives_the_program_s_again() -> None:
    async with console() as (app, pilot):
        await press(pilot, *TO_ODOM, "g", "s")
        await press(pilot, *TO_ODOM, "g")
        assert "self.shared_group" in text_of(app)
        await press(pilot, "p")
        assert app.lesson_screen.runs.run.setup.groups == ()
        assert notes(app)[-1] == "everything is back to what the program says"


@pytest.mark.parametrize("key", ["g", "p"])
async def test_the_set_up_says_that_there_is_no_callback_yet(key: str) -> None:
    async with console(events=Run().events, seconds=0.0) as (app, pilot):
        await press(pilot, key)
        assert "Set-up: there is no callback yet" in text_of(app)


@pytest.mark.slow
async def test_g_without_a_selected_callback_lets_one_be_chosen_first() -> None:
    async with console() as (app, pilot):
        await press(pilot, "g")
        assert isinstance(app.screen, SetupScreen)
        assert "Set-up: no callback is selected, choose one" in text_of(app)
        await press(pilot, "down", "enter")
        assert "Which callback group should scan_callback have?" in text_of(app)
        await press(pilot, "r", "r")
        assert app.lesson_screen.runs.run.setup.groups == (
            GroupChange("/sub_node", "scan_callback", "reentrant"),
        )


async def test_a_value_that_is_not_changed_has_the_room_of_the_changed_one() -> None:
    run = Run()
    group = run.exclusive(run.node("/n"))
    for name in ("take_picture", "take_scan", "weigh_all"):
        run.timer(group, name, 1.0)
    app = RecordedConsole("shared-group", run.events, 1.0)
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        await press(pilot, "p")
        assert "A exclusive, with take_scan, weigh_all" in text_of(app)


# numbers


async def test_p_begins_with_the_period_of_a_timer() -> None:
    async with console() as (app, pilot):
        await press(pilot, "p", "enter")
        assert isinstance(app.screen, ValueScreen)
        assert "self.create_timer(0.5, self.timer_callback, …)" in text_of(app)
        await press(pilot, *"0.2", "enter", "r")
        assert app.lesson_screen.runs.run.setup.periods == (
            PeriodChange("/sub_node", "timer_callback", 200_000_000),
        )


@pytest.mark.slow
async def test_what_is_no_period_is_asked_for_again() -> None:
    async with console() as (app, pilot):
        await press(pilot, "p", "enter", "0", "enter")
        assert "0 is not a period; give 0.001 to 3600 s." in text_of(app)
        assert isinstance(app.screen, ValueScreen)
        await press(pilot, "escape", "escape")
        assert len(sessions(app)) == 1


@pytest.mark.slow
async def test_nothing_typed_is_the_program_s_own_number() -> None:
    async with console() as (app, pilot):
        await press(pilot, "p", "enter", *"0.7", "enter")
        assert "0.7 s" in text_of(app)
        await press(pilot, "enter", "backspace", "enter", "r")
        assert app.lesson_screen.runs.run.setup.periods == ()


@pytest.mark.slow
async def test_a_lesson_s_own_number_and_the_sensors_rate_can_be_changed() -> None:
    async with console(WIDE, "exclusive-2-threads", dummy_server_run().events, 5.2) as (app, pilot):
        await press(pilot, "p", "down", "enter", *"2.5", "enter")
        assert "node.py … -service_wait_time 2.5" in text_of(app)
        await press(pilot, "down", "enter", "5", "enter", "r")
        setup = app.lesson_screen.runs.run.setup
        assert "-service_wait_time 2.5" in " ".join(setup.programs[0].arguments)
        assert setup.sensor_rate == 5
        assert "changed: -service_wait_time 2.5, sensors 5 Hz" in text_of(app)


# the release


async def test_the_release_can_be_changed_and_what_is_none_is_asked_for_again() -> None:
    async with console() as (app, pilot):
        await press(pilot, "p", "end", "enter", *"noetic", "enter")
        assert "'noetic' is no distribution; give humble, jazzy, kilted or lyrical." in text_of(app)
        await press(pilot, *["backspace"] * 6, *"Kilted")
        assert "# cbtui: distro = kilted@9.1.2" in text_of(app)
        await press(pilot, "enter", "r")
        assert app.lesson_screen.runs.run.setup.distro == "kilted@9.1.2"
        assert "changed: kilted@9.1.2" in lines_of(app)[8]
        await press(pilot, "p", "end", "enter", "backspace", "enter", "r")
        assert app.lesson_screen.runs.run.setup.distro == ""


async def test_on_real_ros_the_release_is_fixed_and_undoing_all_stays_there(tmp_path: Path) -> None:
    file = tmp_path / "my_node.py"
    file.write_text("")
    engines = FakeEngines(shared_group_run().events, ns(12.9))
    changes = Changes(threads=2, real=RealRos())
    app = CbtuiApp(start_file=(file, [], "real"), start_changes=changes, open_session=engines)
    async with app.run_test(size=WIDE) as pilot:
        await settle(pilot)
        await press(pilot, "p", "end")
        assert "fixed: real ROS 2 has its own" in text_of(app)
        rows = app.screen.query_one(OptionList)
        assert rows.get_option_at_index(rows.option_count - 1).disabled
        assert rows.highlighted == rows.option_count - 2
        await press(pilot, "u", "r")
        setup = engines.sessions[-1].setup
        assert (setup.threads, setup.real) == (None, RealRos())


async def test_on_real_ros_the_keys_of_time_tell_why_they_do_nothing(tmp_path: Path) -> None:
    file = tmp_path / "my_node.py"
    file.write_text("")
    engines = FakeEngines(shared_group_run().events, ns(12.9))
    app = CbtuiApp(start_file=(file, [], "real"), start_changes=Changes(real=RealRos()), open_session=engines)
    async with app.run_test(size=WIDE, notifications=True) as pilot:
        await settle(pilot)
        for key in ("space", "full_stop", "minus", "plus", "W"):
            app.clear_notifications()
            await press(pilot, key)
            assert notes(app) == [
                "Real ROS 2 goes on by itself: only the model's time can be stopped, stepped or changed."
            ]
        await press(pilot, "comma", "full_stop")
        assert engines.sessions[-1].commands == []
        await press(pilot, "question_mark", "slash", *"pause:", "enter")
        assert "Pause: stop time for every thread" in text_of(app)
        assert "(not on real ROS 2)" in text_of(app)


async def test_on_real_ros_the_diagnosis_says_where_cures_are_tried(tmp_path: Path) -> None:
    file = tmp_path / "my_node.py"
    file.write_text("")
    engines = FakeEngines(shared_group_run().events, ns(12.9))
    app = CbtuiApp(start_file=(file, [], "real"), start_changes=Changes(real=RealRos()), open_session=engines)
    async with app.run_test(size=WIDE) as pilot:
        await settle(pilot)
        await press(pilot, "d")
        assert "Cures are tried only on the model: open the program without --on ros2" in text_of(app)


async def test_on_real_ros_a_moment_to_come_is_not_paused_at(tmp_path: Path) -> None:
    file = tmp_path / "my_node.py"
    file.write_text("")
    engines = FakeEngines(shared_group_run().events, ns(12.9))
    app = CbtuiApp(start_file=(file, [], "real"), start_changes=Changes(real=RealRos()), open_session=engines)
    async with app.run_test(size=WIDE) as pilot:
        await settle(pilot)
        await press(pilot, "G")
        assert "The run is at 12.9" in text_of(app)
        assert "pauses there" not in text_of(app)
        await press(pilot, *("backspace",) * 8, *"20", "enter")
        assert engines.sessions[-1].commands == []


# notifications


@pytest.mark.parametrize("size", first_daily(NARROW, WIDE))
async def test_a_notification_hides_neither_the_diagnosis_nor_the_keys(size: tuple[int, int]) -> None:
    async with console(size) as (app, pilot):
        await press(pilot, "t", "o")
        assert notes(app) == ["everything is back to what the program says"]
        assert app.screen.query_one(Toast).region.bottom == app.screen.query_one(DiagnosisLine).region.y
        await press(pilot, "d")
        app.notify("told while the window is open")
        await pilot.pause()
        keys = next(bar for bar in app.screen.query(KeyBar) if bar.display)
        assert app.screen.query_one(Toast).region.bottom <= keys.region.y


async def test_a_notification_hides_no_line_of_how_a_run_ended() -> None:
    run = shared_group_run()
    run.over(12.5, f"node.py:55: the program raised ValueError: {'word ' * 20}", failed=True)
    async with console(events=run.events) as (app, pilot):
        app.notify("told while the end is on screen")
        await pilot.pause()
        line = app.screen.query_one(DiagnosisLine)
        assert line.region.height > 1
        assert app.screen.query_one(Toast).region.bottom == line.region.y


async def test_a_run_with_other_threads_says_that_the_calls_of_the_run_before_are_not_repeated() -> None:
    called = CommandGiven(ns(12.0), "call /motor_power true", CommandKind.CALL)
    async with console(events=[*shared_group_run().events, called]) as (app, pilot):
        await press(pilot, "t", "4")
        note = "The calls of the run before are not repeated: s calls."
        assert notes(app) == [f"executor = MultiThreadedExecutor(num_threads=4)\n{note}"]


# several at once


@pytest.mark.slow
async def test_several_changes_make_one_run_that_is_compared_with_the_one_before_all() -> None:
    async with console() as (app, pilot):
        await press(pilot, "g", "enter", "o", "up", "enter", "4", "r")
        setup = app.lesson_screen.runs.run.setup
        assert (setup.groups, setup.threads) == ((ODOM_OWN,), 4)
        assert len(sessions(app)) == 2
        assert app.lesson_screen.restarts.before is not None
        assert app.lesson_screen.restarts.before.name == "shared-group, as written"
        assert notes(app) == ["changed: odom own group, 4 threads"]


@pytest.mark.slow
async def test_undoing_all_has_everything_as_the_program_says() -> None:
    async with console() as (app, pilot):
        await press(pilot, "t", "4")
        await press(pilot, "p")
        assert "executor = MultiThreadedExecutor(num_threads=4)" in text_of(app)
        await press(pilot, "u")
        assert "# nothing is changed" in text_of(app)
        assert "u undo all" not in text_of(app)
        await press(pilot, "r")
        assert app.lesson_screen.runs.run.setup.threads is None


@pytest.mark.slow
async def test_an_edited_copy_that_runs_is_told_with_its_lines(tmp_path: Path) -> None:
    path = tmp_path / "node.py"
    path.write_text("a = 1\n")
    async with console(size=WIDE) as (app, pilot):
        app.lesson_screen.restarts.changes = Changes(texts={str(path): "a = 2\n"})
        await press(pilot, "p")
        text = text_of(app)
        assert "# an edited copy of node.py is run" in text
        assert "+a = 2" in text
        assert "# nothing is changed" not in text


@pytest.mark.slow
async def test_thinking_better_of_the_set_up_leaves_the_run_alone() -> None:
    async with console() as (app, pilot):
        await press(pilot, "g", "enter", "o", "escape")
        assert len(sessions(app)) == 1
        await press(pilot, "p")
        assert "# nothing is changed" in text_of(app)


# what stays


@pytest.mark.slow
async def test_running_again_keeps_the_changes_and_another_lesson_drops_them() -> None:
    async with console() as (app, pilot):
        await press(pilot, *TO_ODOM, "g", "o")
        sessions(app)[-1].end("gone")
        await settle(pilot)
        await press(pilot, "r")
        assert app.lesson_screen.runs.run.setup.groups == (ODOM_OWN,)
        predict(app, "split-groups")
        await press(pilot, "n")
        assert not app.lesson_screen.runs.run.setup.groups


@pytest.mark.parametrize(("size", "row"), first_row_daily((NARROW, 8), (WIDE, 1)))
async def test_the_screen_says_what_is_changed(size: tuple[int, int], row: int) -> None:
    async with console(size) as (app, pilot):
        assert "changed:" not in text_of(app)
        await press(pilot, *TO_ODOM, "g", "o")
        assert "changed: odom own group" in lines_of(app)[row]


@pytest.mark.slow
async def test_a_run_before_any_callback_offers_what_can_be_changed_all_the_same() -> None:
    async with console(seconds=-1) as (app, pilot):
        await press(pilot, "g")
        assert "executor" in text_of(app)
        assert "robot's sensors" in text_of(app)
        await press(pilot, "enter", "2", "r")
        assert app.lesson_screen.runs.run.setup.threads == 2


async def test_the_console_can_be_opened_with_changes(tmp_path: Path) -> None:
    file = tmp_path / "my_node.py"
    file.write_text("")
    engines = FakeEngines(shared_group_run().events, ns(12.9))
    changes = Changes(groups={("", "odom_callback"): "own"})
    app = CbtuiApp(start_file=(file, [], "virtual"), start_changes=changes, open_session=engines)
    async with app.run_test(size=WIDE) as pilot:
        await settle(pilot)
        screen = app.screen
        assert isinstance(screen, LessonScreen)
        assert screen.runs.run.setup.groups == (GroupChange("", "odom_callback", "own"),)
        assert "changed: odom own group" in text_of(app)


@pytest.mark.slow
async def test_a_real_run_has_the_group_that_was_chosen() -> None:
    app = CbtuiApp(start_lesson="shared-group")
    predict(app, "shared-group")
    async with app.run_test(size=WIDE) as pilot:

        async def groups() -> dict[str, int]:
            """The group of each callback once the run has all three."""
            async with asyncio.timeout(_PATIENCE):
                while True:
                    await settle(pilot)
                    screen = app.screen
                    assert isinstance(screen, LessonScreen)
                    entities = screen.runs.run.timeline.entities.values()
                    found = {each.callback: each.group for each in entities}
                    if "timer_callback" in found:
                        return found
                    await asyncio.sleep(0.02)

        before = await groups()
        assert before["odom_callback"] == before["timer_callback"]
        await press(pilot, "g", "enter", "o", "r")
        after = await groups()
        assert after["odom_callback"] != after["timer_callback"] == after["scan_callback"]
