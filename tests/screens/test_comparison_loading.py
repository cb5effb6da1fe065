"""The runs that a command line names are made, and then compared."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import pytest
from textual.pilot import Pilot

from cbtui.app import CbtuiApp
from cbtui.runs.compared_runs import ComparedRun, ComparisonTerms, RunProgress
from cbtui.runs.setup.changes import Changes
from cbtui.runs.setup.lesson_setup import RunRequest
from cbtui.screens.compare import CompareScreen
from cbtui.screens.comparison_loading import ComparisonLoadingScreen
from cbtui.screens.menu import MenuScreen
from lessons.catalogue import find
from tests.support.builder import ns
from tests.support.console import WIDE
from tests.support.exercises import until
from tests.support.pictures import text_of


def compared_run(lesson: str, threads: int | None = None) -> ComparedRun:
    return ComparedRun(lesson, RunRequest(lesson=find(lesson), changes=Changes(threads)))


@asynccontextmanager
async def gathering(
    first: ComparedRun, second: ComparedRun, terms: ComparisonTerms
) -> AsyncIterator[tuple[CbtuiApp, Pilot[None]]]:
    app = CbtuiApp(start_comparison=(first, second, terms))
    app.animation_level = "none"
    async with app.run_test(size=WIDE, notifications=True) as pilot:
        await pilot.pause()
        yield app, pilot


async def test_two_lessons_are_run_and_then_compared() -> None:
    terms = ComparisonTerms(end=3.0, calls=(1.2,))
    first, second = compared_run("exclusive-2-threads"), compared_run("reentrant-1-thread", threads=2)
    async with gathering(first, second, terms) as (app, pilot):
        assert isinstance(app.screen, ComparisonLoadingScreen | CompareScreen)
        while isinstance(app.screen, ComparisonLoadingScreen):
            await asyncio.sleep(0.02)
        assert isinstance(app.screen, CompareScreen)
        await until(pilot, lambda: "As asked, 0 to 3 s" in text_of(app))
        assert [side.timeline.end for side in app.screen._sides] == [ns(3.0)] * 2
        picture = text_of(app)
        assert "SetBool_callback" in picture
        assert "MultiThreadedExecutor(2)" in picture


async def test_what_cannot_be_compared_is_said_and_ends_the_console_with_2(tmp_path: Path) -> None:
    terms = ComparisonTerms()
    async with gathering(
        ComparedRun("x.mcap", tmp_path / "x.mcap"), compared_run("single-thread"), terms
    ) as (
        app,
        pilot,
    ):
        while "cannot be read" not in text_of(app):
            await asyncio.sleep(0.02)
            await pilot.pause()
        await pilot.press("w", "z", "q")
    assert app.return_code == 2


async def test_a_run_that_takes_long_can_be_given_up() -> None:
    terms = ComparisonTerms(end=36_000)
    async with gathering(compared_run("single-thread"), compared_run("split-groups"), terms) as (app, pilot):
        await pilot.press("q")
        assert isinstance(app.screen, MenuScreen)


@pytest.mark.parametrize(
    ("progress", "sentence"),
    [
        (RunProgress("a", "running", ns(12.34), ns(60)), "running a: 12.3 s of 60 s"),
        (RunProgress("a.mcap", "reading", ns(2)), "reading a.mcap: 2.0 s"),
    ],
)
def test_progress_tells_how_far_a_run_has_come(progress: RunProgress, sentence: str) -> None:
    assert progress.text == sentence
