"""An exercise on screen, with recorded runs: the file, the checks, the keys, and what a save does."""

import re
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from functools import lru_cache, partial
from pathlib import Path

import pytest
from textual.pilot import Pilot

from cbtui.app import CbtuiApp
from cbtui.runs.judged.run_budget import RunBudget
from cbtui.screens.compare import CompareScreen
from cbtui.screens.exercise import ExerciseScreen
from cbtui.screens.lesson import LessonScreen
from cbtui.screens.windows.solution import SolutionScreen
from cbtui.widgets.checks import ChecksView
from cbtui.widgets.code import CodeView
from cbtui.widgets.key_bar import KeyBar
from lessons.catalogue import find
from lessons.progress import Progress
from sim.engine.commands import Pause
from sim.trace.events import AnyEvent
from tests.support.console import NARROW, WIDE, RecordedConsole, settle
from tests.support.exercises import (
    FILE,
    LESSON,
    SOLUTION,
    STARTER,
    Engines,
    ExerciseConsole,
    is_judged,
    judged_run,
    until,
)
from tests.support.pictures import lines_of, text_of

SECOND = 1_000_000_000


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Work in an empty folder."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@lru_cache
def failing() -> list[AnyEvent]:
    return judged_run(STARTER)


@lru_cache
def passing() -> list[AnyEvent]:
    return judged_run(SOLUTION)


@asynccontextmanager
async def console(
    events: list[AnyEvent], size: tuple[int, int] = NARROW
) -> AsyncIterator[tuple[ExerciseConsole, Engines, Pilot[None]]]:
    """The exercise with its first run judged."""
    engines = Engines(events)
    app = ExerciseConsole(engines)
    async with app.run_test(size=size) as pilot:
        await settle(pilot)
        await judge(app, engines, pilot)
        yield app, engines, pilot


async def judge(app: ExerciseConsole, engines: Engines, pilot: Pilot[None]) -> None:
    """Let the latest run be over and judged."""
    engines.finish()
    await until(pilot, lambda: is_judged(app.exercise))
    app.clear_notifications()
    await settle(pilot)


def offered(app: ExerciseConsole) -> set[str]:
    return {action.id for action in app.screen.query_one(KeyBar).working()}


def kind_of_screen(app: CbtuiApp) -> type[object]:
    return type(app.screen)


def started(engines: Engines, number: int) -> bool:
    """Whether the run with that number goes on; by then the one before it was ended."""
    return len(engines.sessions) == number and engines.latest.started


def watching(app: ExerciseConsole) -> bool:
    return any(worker.group == "file" for worker in app.workers)


# the way there


async def test_e_puts_the_starter_here_and_goes_to_the_exercise(here: Path) -> None:
    Progress().see(LESSON.id)
    app = RecordedConsole(LESSON.id, [], 0.0)
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        await pilot.press("e")
        await settle(pilot)
        assert kind_of_screen(app) is ExerciseScreen
        assert (here / FILE).read_bytes() == STARTER.read_bytes()
        (told,) = app._notifications
        assert told.message == f"{FILE} is yours now, in {here}: it is checked whenever you save it."
        assert app.engines.latest.setup.programs[0].path == str(here / FILE)
        await pilot.press("e")
        await settle(pilot)
        assert kind_of_screen(app) is LessonScreen


async def test_leaving_a_lesson_that_shows_a_problem_comes_back_to_the_exercise(here: Path) -> None:
    app = ExerciseConsole(Engines([]))
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        app.exercise.selection._show_lesson(find("single-thread"))
        await settle(pilot)
        await pilot.press("q")
        await settle(pilot)
        assert kind_of_screen(app) is ExerciseScreen


@pytest.mark.slow
async def test_a_file_that_was_changed_is_kept_and_used(here: Path) -> None:
    (here / FILE).write_text("mine = True\n")
    app = ExerciseConsole(Engines([]))
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        assert (here / FILE).read_text() == "mine = True\n"
        (told,) = app._notifications
        assert told.message.startswith(f"Your {FILE} in {here} is kept as it is")


@pytest.mark.slow
async def test_a_folder_that_takes_no_file_is_told_of_and_nothing_happens(here: Path) -> None:
    Progress().see(LESSON.id)
    (here / FILE).mkdir()
    app = RecordedConsole(LESSON.id, [], 0.0)
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        screen = app.screen
        await pilot.press("e")
        await settle(pilot)
        assert app.screen is screen
        (told,) = app._notifications
        assert told.message == f"{here / FILE} is there already, and is not a file"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("key", "sentence"),
    [("t", "This runs your file as it will be judged"), ("space", "The run is over: r runs it again.")],
)
async def test_a_key_without_effect_on_an_exercise_says_why(here: Path, key: str, sentence: str) -> None:
    async with console(failing()) as (app, _, pilot):
        await pilot.press(key)
        assert any(note.message.startswith(sentence) for note in app._notifications)


async def test_a_lesson_without_an_exercise_does_not_offer_one() -> None:
    Progress().see("single-thread")
    app = RecordedConsole("single-thread", [], 0.0)
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        assert not app.screen.check_action("exercise", ())
        await pilot.press("e")
        assert isinstance(app.screen, LessonScreen)


# checks


async def test_the_run_on_screen_is_the_one_that_is_judged() -> None:
    async with console(failing()) as (_, engines, _pilot):
        setup = engines.latest.setup
        assert (setup.speed, setup.until, setup.threads) == (None, 30 * SECOND, None)


async def test_checks_that_fail_are_shown_and_enter_goes_to_their_moment() -> None:
    async with console(failing()) as (app, _, pilot):
        picture = text_of(app)
        assert "7 Checks" in picture
        assert "✗ 1 of 5 pass" in picture
        assert "✗ /odom keeps coming" in picture
        await pilot.press("down", "down", "enter")
        await settle(pilot)
        assert "t 14.000 s" in text_of(app)
        progress = Progress().of(LESSON.id)
        assert (progress.passed, progress.seen) == (False, False)


async def test_enter_on_a_check_goes_to_the_line_of_an_error_of_syntax(here: Path) -> None:
    (here / FILE).write_text("import rclpy\n\ndef main(:\n")
    async with console(judged_run(here / FILE)) as (app, _, pilot):
        await pilot.press("enter")
        await settle(pilot)
        code = app.screen.query_one(CodeView)
        assert (code.has_focus, code.picked) == (True, 3)


async def test_enter_on_a_check_that_is_not_judged_says_that_there_is_nothing_to_show() -> None:
    app = ExerciseConsole(Engines([]))
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        app.clear_notifications()
        await pilot.press("enter")
        await settle(pilot)
        assert [each.message for each in app._notifications] == ["There is no moment to show for this check."]
        assert app.screen.query_one(ChecksView).has_focus


@pytest.mark.slow
async def test_checks_that_fail_in_a_run_without_problems_are_not_told_as_well() -> None:
    async with console([event for event in failing() if event.t <= 3 * SECOND]) as (app, _, _pilot):
        assert re.search(r"! \d of 5 checks fail", lines_of(app)[-2])


@pytest.mark.slow
async def test_what_is_asked_can_be_read_by_scrolling() -> None:
    async with console(failing()) as (app, _, pilot):
        assert "The file is the node" not in text_of(app)
        await pilot.press(*["down"] * 12)
        await settle(pilot)
        assert "The file is the node" in text_of(app)


@pytest.mark.slow
async def test_a_file_that_passes_is_noted_and_the_next_lesson_named() -> None:
    async with console(passing()) as (app, _, pilot):
        assert "✓ All 5 checks pass: the exercise is done." in text_of(app)
        assert "Exclusive, 2 threads" in text_of(app)
        assert Progress().of(LESSON.id).passed
        assert "n next" in lines_of(app)[-1]
        assert "hint" not in offered(app)
        await pilot.press("h")
        assert [each.message for each in app._notifications][-1].startswith("No hint is left or needed; H")
        await pilot.press("H")
        assert isinstance(app.screen, SolutionScreen), "nothing is left to find out, so nothing is asked"
        await pilot.press("escape")
        assert "all 5 checks pass, left of the lesson: predict, run, explain" in text_of(app)
        await pilot.press("w")  # another run, of which that is not known
        await settle(pilot)
        assert "opens the next lesson" not in text_of(app)
        assert app.exercise.steps[-1].text == "Exercise ✓"


@pytest.mark.bulk
async def test_where_only_the_exercise_was_left_the_banner_names_the_next_lesson() -> None:
    progress = Progress()
    progress.see(LESSON.id)
    progress.explain(LESSON.id)
    async with console(passing()) as (app, _, _pilot):
        assert "all 5 checks pass, n opens the next lesson" in text_of(app)


@pytest.mark.slow
async def test_a_narrow_screen_has_room_for_the_keys_that_help_with_a_file_that_fails() -> None:
    async with console(failing()) as (app, _, _pilot):
        keys = lines_of(app)[-1]
        assert all(key in keys for key in ("o editor", "go there", "w watch", "h hint", "e lesson"))


@pytest.mark.slow
async def test_the_key_bar_begins_with_what_the_exercise_needs_next() -> None:
    for events, first in ((failing(), ["o", "editor"]), (passing(), ["n", "next"])):
        async with console(events) as (app, _, _pilot):
            assert lines_of(app)[-1].split()[:2] == first


@pytest.mark.slow
async def test_the_guide_says_what_is_asked_where_the_checks_were(here: Path) -> None:
    async with console(failing(), WIDE) as (app, _, pilot):
        await pilot.press("1")
        await settle(pilot)
        picture = text_of(app)
        assert "The file is the node" in picture
        assert "7 Checks" not in picture


# the keys


@pytest.mark.slow
async def test_nothing_is_offered_that_would_make_it_another_run_than_the_judged_one() -> None:
    app = ExerciseConsole(engines := Engines([]))
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        refused = {
            "call_service",
            "threads",
            "group",
            "set_up",
            "prompt",
            "reset_world",
            "exercise",
            "predict",
            "explain",
        }
        assert not refused & offered(app)
        await pilot.press("s", "S", "t", "g", "p", "colon", "space")
        await settle(pilot)
        assert engines.latest.commands == [Pause()]
        assert app.screen is app.exercise


async def test_r_runs_it_again_and_w_at_the_pace_of_real_time() -> None:
    async with console(failing()) as (app, engines, pilot):
        for key in ("w", "r"):
            await pilot.press(key)
            await settle(pilot)
        assert [session.setup.speed for session in engines.sessions] == [None, 1.0, None]
        assert [session.stopped for session in engines.sessions] == [True, True, False]
        assert not is_judged(app.exercise)


# saving


@pytest.mark.slow
async def test_saving_runs_it_again_and_the_run_before_can_be_compared(here: Path) -> None:
    async with console(failing()) as (app, engines, pilot):
        (here / FILE).write_bytes(SOLUTION.read_bytes())
        await until(pilot, partial(started, engines, 2))
        assert engines.sessions[0].stopped
        await judge(app, engines, pilot)
        await pilot.press("C")
        await settle(pilot)
        assert isinstance(app.screen, CompareScreen)
        assert f"{FILE}, run 1" in text_of(app)


@pytest.mark.bulk
async def test_saving_while_it_runs_ends_that_run(here: Path) -> None:
    engines = Engines([])
    app = ExerciseConsole(engines)
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        for number in (2, 3):
            (here / FILE).write_text(f"version = {number}\n")
            await until(pilot, partial(started, engines, number))
        assert [session.stopped for session in engines.sessions] == [True, True, False]


@pytest.mark.bulk
async def test_saving_the_same_again_changes_nothing(here: Path) -> None:
    async with console(failing()) as (_, engines, pilot):
        (here / FILE).write_bytes(STARTER.read_bytes())
        (here / FILE).write_bytes(SOLUTION.read_bytes())
        await until(pilot, lambda: len(engines.sessions) > 1)
        assert len(engines.sessions) == 2


@pytest.mark.slow
async def test_a_file_that_is_gone_is_told_of_and_goes_on_when_it_is_back(here: Path) -> None:
    async with console(failing()) as (app, engines, pilot):
        (here / FILE).unlink()
        await until(pilot, lambda: f"{FILE} is gone; it will be run and checked again" in text_of(app))
        (here / FILE).write_bytes(SOLUTION.read_bytes())
        await until(pilot, lambda: len(engines.sessions) == 2)
        await judge(app, engines, pilot)
        assert "is gone" not in text_of(app)


@pytest.mark.bulk
async def test_no_watch_is_left_behind() -> None:
    async with console(failing()) as (app, _, pilot):
        assert watching(app)
        await pilot.press("q")
        await settle(pilot)
        assert not watching(app)


# runs that come to no good end


async def test_a_run_that_takes_too_much_is_ended_and_told_of() -> None:
    engines = Engines([])
    app = ExerciseConsole(engines)
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        app.exercise._judging.budget = RunBudget(limit=-1)
        await until(pilot, lambda: is_judged(app.exercise) and engines.latest.stopped)
        await settle(pilot)
        assert "was given -1 s of real time" in text_of(app)
        assert not app.exercise.runs.run.alive


@pytest.mark.bulk
async def test_a_paused_run_may_stand_as_long_as_it_likes() -> None:
    engines = Engines([])
    app = ExerciseConsole(engines)
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        app.exercise.runs.run.pause()
        app.exercise._judging.budget = RunBudget(limit=0)
        app.exercise.check_budget()
        await settle(pilot)
        assert app.exercise.runs.run.alive


async def test_an_engine_that_is_lost_is_told_of_in_a_sentence() -> None:
    engines = Engines([])
    app = ExerciseConsole(engines)
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        engines.latest.end("the engine ended with exit code 3")
        await until(pilot, lambda: is_judged(app.exercise))
        await settle(pilot)
        assert text_of(app).count(f"{FILE} ended its whole process at 0.000 s") == 1
        await pilot.press("2")
        await settle(pilot)
        assert text_of(app).count(f"{FILE} ended its whole process at 0.000 s") == 1
