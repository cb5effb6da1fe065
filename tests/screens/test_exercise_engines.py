"""An exercise on screen with real engines: mended, and with files that are no use."""

import threading
from pathlib import Path

import pytest

from cbtui.runs.judged.run_budget import RunBudget
from lessons.progress import Progress
from tests.commands.exercise_files import A_GIGABYTE, ENDLESS_CALLBACK, LEAVES, SYNTAX_ERROR
from tests.support.console import NARROW, settle
from tests.support.exercises import FILE, LESSON, SOLUTION, ExerciseConsole, is_judged, until
from tests.support.pictures import text_of


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Work in an empty folder."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.slow
async def test_the_starter_fails_and_once_mended_it_passes(here: Path) -> None:
    app = ExerciseConsole()
    async with app.run_test(size=NARROW) as pilot:
        await until(pilot, lambda: is_judged(app.exercise))
        await settle(pilot)
        assert "✗ 1 of 5 pass" in text_of(app)
        assert not Progress().of(LESSON.id).passed
        (here / FILE).write_bytes(SOLUTION.read_bytes())
        await until(pilot, lambda: "✓ 5 of 5 pass" in text_of(app))
        assert Progress().of(LESSON.id).passed
    assert not [thread for thread in threading.enumerate() if thread.name == "trace-reader"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        pytest.param(SYNTAX_ERROR, f"{FILE}:28: expected ':'", id="syntax error"),
        pytest.param(LEAVES, f"{FILE} ended its whole process", id="os._exit"),
        pytest.param(A_GIGABYTE, f"{FILE} wrote more than 32 MB", id="a gigabyte of log"),
    ],
)
async def test_a_file_that_cannot_be_judged_is_told_of_and_left_as_it_is(
    here: Path, text: str, sentence: str
) -> None:
    (here / FILE).write_text(text)
    app = ExerciseConsole()
    async with app.run_test(size=NARROW) as pilot:
        await until(pilot, lambda: is_judged(app.exercise))
        await settle(pilot)
        assert sentence in text_of(app)
        assert "5 of 5" not in text_of(app)
    assert (here / FILE).read_text() == text


@pytest.mark.slow
async def test_a_file_that_goes_on_for_ever_is_ended(here: Path) -> None:
    (here / FILE).write_text(ENDLESS_CALLBACK)
    app = ExerciseConsole()
    async with app.run_test(size=NARROW) as pilot:
        await until(pilot, lambda: app.exercise.runs.run.timeline.started is not None)
        app.exercise._judging.budget = RunBudget(limit=0.3)
        await until(pilot, lambda: is_judged(app.exercise))
        await settle(pilot)
        assert f"{FILE} was given 0.3 s of real time" in text_of(app)
        assert not app.exercise.runs.run.alive
