"""How the way through a lesson looks: the questions, the page, the hints, the solution, the checks."""

from collections.abc import Awaitable, Callable
from pathlib import Path

import pytest
from textual.pilot import Pilot

from lessons.progress import Progress
from tests.screens.lesson.test_teaching import WITH_EXERCISE, Console, press, the_lessons_own_run, until_shown
from tests.support.console import NARROW, WIDE, RecordedConsole, settle
from tests.support.daily import first_daily
from tests.support.exercises import SOLUTION, STARTER, Engines, ExerciseConsole, is_judged, judged_run, until
from tests.support.runs import shared_group_run

Compare = Callable[..., bool]
Before = Callable[[Pilot[None]], Awaitable[None]]


def pressed(*keys: str) -> Before:
    """Press keys, each when what the one before it did is on screen."""

    async def before(pilot: Pilot[None]) -> None:
        await settle(pilot)
        await press(pilot, *keys)

    return before


def test_the_question_before_a_run_looks_as_it_did(snap_compare: Compare) -> None:
    assert snap_compare(Console(), terminal_size=NARROW, run_before=pressed("2"))


@pytest.mark.slow
@pytest.mark.parametrize("size", first_daily(WIDE, NARROW), ids=["140x40", "80x24"])
def test_a_right_and_a_wrong_prediction_look_as_they_did(
    snap_compare: Compare, size: tuple[int, int]
) -> None:
    app = Console(observe=the_lessons_own_run())

    async def explained(pilot: Pilot[None]) -> None:
        await pressed("1", "enter", "1", "enter", "a")(pilot)
        await until_shown(pilot, app, "You got 1 of 2")
        await settle(pilot)

    assert snap_compare(app, terminal_size=size, run_before=explained)


@pytest.mark.parametrize(
    "keys", first_daily(("h",), ("H",), ("H", "enter")), ids=["hint", "solution-asked-about", "solution"]
)
def test_help_with_an_exercise_looks_as_it_did(snap_compare: Compare, keys: tuple[str, ...]) -> None:
    Progress().see(WITH_EXERCISE.id)
    app = Console(lesson=WITH_EXERCISE.id)
    assert snap_compare(app, terminal_size=NARROW, run_before=pressed(*keys))


@pytest.mark.parametrize("file", first_daily(STARTER, SOLUTION), ids=["failing", "passing"])
def test_the_checks_of_an_exercise_look_as_they_did(
    snap_compare: Compare, file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    engines = Engines(judged_run(file))
    app = ExerciseConsole(engines)
    app.progress.passes(app._start_exercise or "")

    async def judged(pilot: Pilot[None]) -> None:
        await settle(pilot)
        engines.finish()
        await until(pilot, lambda: is_judged(app.exercise))
        app.clear_notifications()
        await settle(pilot)

    assert snap_compare(app, terminal_size=NARROW, run_before=judged)


def test_the_choice_of_a_format_looks_as_it_did(snap_compare: Compare) -> None:
    app = RecordedConsole("shared-group", shared_group_run().events, 14.25)
    assert snap_compare(app, terminal_size=NARROW, run_before=pressed("x"))
