"""The way through a lesson: predict, run, see what the run showed, have it explained, take hints."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from threading import Event

import pytest
from textual.containers import VerticalScroll
from textual.pilot import Pilot

from cbtui.app import CbtuiApp
from cbtui.learning.lesson_page import introduction
from cbtui.learning.outcome import Observe
from cbtui.runs.judged.checking import ObservedRun, observe
from cbtui.runs.setup.lesson_setup import setup_to_judge
from cbtui.screens.lesson import LessonScreen
from cbtui.screens.menu import MenuScreen
from cbtui.screens.windows.diagnoses import DiagnosesScreen
from cbtui.screens.windows.prediction import PredictionScreen
from cbtui.screens.windows.solution import ConfirmSolutionScreen, SolutionScreen
from cbtui.widgets.guide import Guide
from lessons.catalogue import find, is_built_in, lessons
from lessons.progress import LessonProgress, Progress
from sim.engine.setup import RunSetup
from sim.trace.events import RunEnded, ServiceCalled
from sim.trace.timeline import Timeline
from tests.support.builder import ns
from tests.support.console import NARROW, observed, settle
from tests.support.engine_runs import run_lesson
from tests.support.exercises import until
from tests.support.fake_session import FakeEngines
from tests.support.pictures import lines_of, text_of
from tests.support.runs import shared_group_run, split_groups_run

EVENTS = shared_group_run().events
LESSON = find("shared-group")
FIRST, SECOND = LESSON.predictions
WITH_EXERCISE = find("split-groups")
_PATIENCE = 60.0


class Console(CbtuiApp):
    """A console on a lesson of which the learner knows nothing yet."""

    def __init__(self, seconds: float = 2.0, lesson: str = LESSON.id, observe: Observe | None = None) -> None:
        self.engines = FakeEngines(EVENTS, ns(seconds))
        super().__init__(start_lesson=lesson, open_session=self.engines, observe=observe or observed(EVENTS))
        self.animation_level = "none"

    @property
    def page(self) -> str:
        """The text of the guide, in sight or not."""
        guide = self.screen_stack[1].query_one(Guide)
        return "\n".join(guide._parts.values())

    def started(self) -> bool:
        """Whether time has begun."""
        return self.engines.latest.started

    def kept(self) -> LessonProgress:
        """What another console would know of the lesson."""
        assert self._start_lesson is not None
        return Progress().of(self._start_lesson)


@asynccontextmanager
async def console(
    seconds: float = 2.0, lesson: str = LESSON.id, observe: Observe | None = None, *keys: str
) -> AsyncIterator[tuple[Console, Pilot[None]]]:
    app = Console(seconds, lesson, observe)
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        await press(pilot, *keys)
        yield app, pilot


async def press(pilot: Pilot[None], *keys: str) -> None:
    for key in keys:
        await pilot.press(key)
        await settle(pilot)


async def until_shown(pilot: Pilot[None], app: Console, text: str) -> None:
    async with asyncio.timeout(_PATIENCE):
        while text not in app.page:
            await pilot.pause(0.01)


def the_lessons_own_run() -> Observe:
    """What an engine makes of the lesson."""
    return observed(run_lesson(LESSON.id, LESSON.run.seconds).events)


def top(app: CbtuiApp) -> type[object]:
    return type(app.screen)


# predict


@pytest.mark.slow
async def test_what_every_lesson_is_about_is_read_without_scrolling() -> None:
    app = Console()
    async with app.run_test(size=NARROW) as pilot:
        for lesson in filter(is_built_in, lessons()):
            text = introduction(lesson.guide)
            screen = PredictionScreen(text, lesson.predictions, 0, lambda _place, _answer: None, app.charset)
            await app.push_screen(screen)
            await settle(pilot)
            assert screen.query_one(VerticalScroll).max_scroll_y == 0, lesson.id
            await screen.dismiss()


async def test_time_does_not_begin_before_every_question_is_answered() -> None:
    async with console() as (app, pilot):
        assert top(app) is PredictionScreen
        assert FIRST.question[:20] in text_of(app)
        await press(pilot, "1", "enter")
        assert SECOND.question[:20] in text_of(app)
        assert not app.started()
        await press(pilot, "down", "down", "enter")
        assert top(app) is LessonScreen
        assert app.started()
        assert app.kept().answers == (0, 1)


async def test_enter_without_a_choice_says_that_one_comes_first() -> None:
    async with console() as (app, pilot):
        assert "your answer is final" in text_of(app)
        await press(pilot, "enter")
        assert f"choose an answer first: 1 to {len(FIRST.answers)}" in text_of(app)
        await press(pilot, "1")
        assert "your answer is final" in text_of(app)
        assert not app.kept().answers


async def test_an_answer_that_is_only_highlighted_is_none() -> None:
    async with console() as (app, pilot):
        await press(pilot, "enter", "enter")
        assert app.kept().answers == ()
        await press(pilot, "2", "escape")
        assert app.started()
        assert app.kept().answers == ()


@pytest.mark.slow
async def test_a_given_answer_stays_and_is_not_asked_for_again() -> None:
    async with console() as (app, pilot):
        await press(pilot, "2", "enter", "q")
        assert top(app) is MenuScreen
        assert app.kept().answers == (1,)
        await press(pilot, "2", "enter")
        assert FIRST.question[:20] not in text_of(app)
        assert SECOND.question[:20] in text_of(app)
        await press(pilot, "1", "enter")
        assert app.kept().answers == (1, 0)
        await press(pilot, "P")
        assert top(app) is LessonScreen


async def test_who_goes_back_from_the_questions_has_started_nothing() -> None:
    async with console() as (app, pilot):
        await press(pilot, "q")
        assert top(app) is MenuScreen
        opened = (session for session in app.engines.sessions if session.setup.title == LESSON.id)
        assert not any(session.started for session in opened)


@pytest.mark.slow
async def test_a_run_without_predicting_can_be_predicted_later() -> None:
    async with console() as (app, pilot):
        await press(pilot, "escape")
        assert app.started()
        await press(pilot, "P", "1", "enter", "1", "enter")
        assert app.kept().answers == (0, 0)
        assert len(app.engines.sessions) == 1


async def test_changes_from_the_command_line_begin_to_run_at_once() -> None:
    from cbtui.runs.setup.changes import Changes

    engines = FakeEngines(EVENTS, ns(2))
    app = CbtuiApp(start_lesson=LESSON.id, start_changes=Changes(threads=4), open_session=engines)
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        assert top(app) is LessonScreen
        assert engines.latest.started


# nothing is given away


async def test_the_questions_are_asked_beside_what_gives_nothing_away() -> None:
    async with console() as (app, _):
        assert "Set-up." in text_of(app)
        assert "still wait" not in text_of(app)
        assert "It looks like the lesson before" not in app.page
        assert "## Why" not in app.page


@pytest.mark.slow
async def test_a_page_that_was_not_predicted_gives_nothing_away() -> None:
    async with console() as (app, pilot):
        await press(pilot, "escape")
        assert "No prediction yet" in app.page
        assert LESSON.task is not None
        assert LESSON.task in app.page
        for told in ("still wait", FIRST.because, SECOND.because, "# What there is to see", "Four workers"):
            assert told not in app.page


async def test_a_predicted_page_tells_what_to_watch_for_and_not_what_is_true() -> None:
    async with console() as (app, pilot):
        await press(pilot, "2", "enter", "1", "enter")
        assert f"> {FIRST.answers[1]}" in app.page
        assert "## Watch" in app.page
        for told in (FIRST.because, SECOND.because, SECOND.answers[SECOND.right], "✓", "✗", "Four workers"):
            assert told not in app.page


# see and explain


@pytest.mark.slow
async def test_what_was_explained_is_gone_to_from_every_pane() -> None:
    async with console(30.1, LESSON.id, observed(EVENTS), "1", "enter", "2", "enter") as (app, pilot):
        await press(pilot, "a")
        await until_shown(pilot, app, "You got")
        guide = app.screen.query_one(Guide)
        for pane in "2345":
            guide.scroll_to(y=0, animate=False, immediate=True)
            await press(pilot, pane, "a")
            assert app.screen.query_one("#part-shown").virtual_region.y == guide.scroll_offset.y > 0, pane


@pytest.mark.slow
async def test_who_reads_on_while_the_prediction_is_checked_is_not_taken_back() -> None:
    checked = Event()

    def observe_later(setup: RunSetup, name: str, given_up: Event) -> ObservedRun:
        checked.wait(_PATIENCE)
        return observed(EVENTS)(setup, name, given_up)

    async with console(30.1, LESSON.id, observe_later, "1", "enter", "2", "enter", "a") as (app, pilot):
        guide = app.screen.query_one(Guide)
        await until(pilot, lambda: guide.scroll_offset.y > 0)
        await press(pilot, "pagedown", "pagedown")
        reading = guide._read_now(guide._parts)
        checked.set()
        await until_shown(pilot, app, "You got")
        await pilot.pause(0.1)
        assert guide._read_now(guide._parts) == reading
        assert guide.is_past("shown")


@pytest.mark.slow
async def test_what_one_lesson_said_does_not_cover_the_keys_of_the_next() -> None:
    app = Console(30.1)
    async with app.run_test(size=NARROW, notifications=True) as pilot:
        await press(pilot, "1", "enter", "2", "enter")
        app.clear_notifications()
        await until(pilot, lambda: not app.screen.query("Toast"))
        app.notify("something that stays for a while", timeout=60)
        await until(pilot, lambda: len(app._notifications) > 0 and len(app.screen.query("Toast")) > 0)
        before = app.screen
        app.open_lesson(WITH_EXERCISE)
        await until(pilot, lambda: top(app) is PredictionScreen and app.screen is not before)
        await pilot.pause(0.1)
        assert not app.screen.query("Toast")


@pytest.mark.slow
async def test_a_key_holds_the_prediction_against_a_run_and_explains() -> None:
    async with console(observe=the_lessons_own_run()) as (app, pilot):
        await press(pilot, "1", "enter", "1", "enter", "a")
        await until_shown(pilot, app, "You got 1 of 2")
        assert f"✓ You were right: **{FIRST.answers[0]}**" in app.page
        assert f"✗ You said: {SECOND.answers[0]}\n\n→ What happened: **{SECOND.answers[1]}**" in app.page
        assert FIRST.because in app.page
        assert "Checked against a run of 30 s." in app.page
        assert "What there is to see" in app.page
        assert "Four workers" in app.page
        assert app.kept().seen


@pytest.mark.slow
async def test_an_explanation_says_while_its_call_was_not_made() -> None:
    async with console(3.0, "rate-sleep-in-a-callback") as (app, pilot):
        await press(pilot, "escape", "a", "escape")
        await until_shown(pilot, app, "Not yet: nobody has called `/walk_round` in this run. `s` does.")
        app.engines.latest._deliver([ServiceCalled(ns(3.1), 1, "/walk_round", 0, "")])
        await until(pilot, lambda: "Not yet" not in app.page)
        assert "What there is to see" in app.page


@pytest.mark.slow
async def test_enough_of_a_run_unlocks_what_it_showed() -> None:
    async with console(29.0, observe=the_lessons_own_run()) as (app, pilot):
        await press(pilot, "1", "enter", "2", "enter")
        assert not app.kept().seen
        app.engines.latest.play(ns(30.1))
        await settle(pilot)
        await until_shown(pilot, app, "You got 2 of 2")
        assert app.kept().seen


@pytest.mark.slow
async def test_what_is_unlocked_is_told_once_no_window_is_open() -> None:
    async with console(29.0, LESSON.id, the_lessons_own_run(), "1", "enter", "2", "enter", "d") as (
        app,
        pilot,
    ):
        assert top(app) is DiagnosesScreen
        app.engines.latest.play(ns(30.1))
        await settle(pilot)
        assert not any("what happened, and why" in each.message for each in app._notifications)
        await press(pilot, "escape")
        await until(
            pilot, lambda: any("what happened, and why" in each.message for each in app._notifications)
        )


@pytest.mark.slow
@pytest.mark.parametrize("failed", [False, True])
async def test_a_run_that_failed_has_shown_nothing(failed: bool) -> None:
    async with console(3.0, observe=the_lessons_own_run()) as (app, pilot):
        await press(pilot, "1", "enter", "2", "enter")
        app.engines.latest._deliver([RunEnded(ns(3.1), "the program is over", failed)])
        await settle(pilot)
        assert app.kept().seen is not failed


@pytest.mark.slow
async def test_a_run_that_is_meant_to_fail_has_shown_all_by_then() -> None:
    async with console(3.0, "lost-exceptions") as (app, pilot):
        await press(pilot, "1", "enter", "2", "enter")
        app.engines.latest._deliver([RunEnded(ns(12.0), "the program raised ValueError", failed=True)])
        await settle(pilot)
        assert app.kept().seen


@pytest.mark.slow
async def test_what_is_being_read_stays_in_its_place_when_the_run_unlocks_what_it_showed() -> None:
    async with console(29.0, LESSON.id, the_lessons_own_run(), "1", "enter", "2", "enter") as (app, pilot):
        guide, read = app.screen.query_one(Guide), app.screen.query_one("#part-guide")
        guide.scroll_to(y=read.virtual_region.y + 2, animate=False, immediate=True)
        app.engines.latest.play(ns(30.1))
        await settle(pilot)
        await until_shown(pilot, app, "You got 2 of 2")
        await settle(pilot)
        assert read.virtual_region.y - guide.scroll_offset.y == -2


@pytest.mark.slow
@pytest.mark.parametrize(("lesson", "key"), [(LESSON.id, "n next"), (WITH_EXERCISE.id, "e exercise")])
async def test_the_keys_of_a_narrow_screen_tell_the_way_on_after_the_explanation(
    lesson: str, key: str
) -> None:
    Progress().see(lesson)
    async with console(lesson=lesson) as (app, _):
        assert key in lines_of(app)[-1]


@pytest.mark.slow
async def test_who_asks_for_the_answer_may_predict_first_or_leave_it() -> None:
    async with console() as (app, pilot):
        await press(pilot, "escape", "a")
        assert top(app) is PredictionScreen
        await press(pilot, "q")
        assert not app.kept().seen
        await press(pilot, "a", "escape")
        await until_shown(pilot, app, "You made no prediction. What happened")
        assert app.kept().answers == ()
        await press(pilot, "P")
        assert top(app) is LessonScreen


@pytest.mark.slow
async def test_a_run_that_shows_something_else_outdoes_the_lesson() -> None:
    async with console(observe=observed(split_groups_run().events)) as (app, pilot):
        await press(pilot, "1", "enter", "2", "enter", "a")
        await until_shown(pilot, app, "What the run showed: ")
        assert "the run shows something else, and the run counts" in app.page
        assert FIRST.because not in app.page


@pytest.mark.slow
async def test_a_run_that_cannot_be_held_against_is_told_of_in_a_sentence() -> None:
    def broken(_setup: RunSetup, name: str, _given_up: Event) -> ObservedRun:
        return ObservedRun(Timeline(), f"{name} ended its whole process at 0.000 s", broken_off=True)

    async with console(observe=broken) as (app, pilot):
        await press(pilot, "1", "enter", "2", "enter", "a")
        await until_shown(pilot, app, "could not be checked against a run: node.py ended its whole process")
        assert FIRST.because not in app.page


@pytest.mark.slow
async def test_a_screen_that_is_left_breaks_off_the_run_beside_it() -> None:
    begun, over = Event(), Event()

    def endless(_setup: RunSetup, _name: str, given_up: Event) -> ObservedRun:
        begun.set()
        assert given_up.wait(_PATIENCE)
        over.set()
        return ObservedRun(Timeline(), "broken off", broken_off=True)

    async with console(observe=endless) as (app, pilot):
        await press(pilot, "1", "enter", "2", "enter", "a")
        await until_shown(pilot, app, "runs once more to check your prediction")
        assert begun.wait(_PATIENCE)
        await press(pilot, "q")
        assert top(app) is MenuScreen
        await until(pilot, over.is_set)


def test_a_run_that_nobody_wants_any_more_comes_to_its_end() -> None:
    given_up = Event()
    given_up.set()
    run = observe(setup_to_judge(LESSON), "node.py", given_up=given_up)
    assert run.broken_off
    assert run.trouble == "node.py was stopped at 0.000 s"


@pytest.mark.slow
async def test_who_has_watched_a_lesson_gets_straight_to_its_run() -> None:
    Progress().see(LESSON.id)
    async with console() as (app, pilot):
        assert top(app) is LessonScreen
        assert app.started()
        assert "What there is to see" in app.page
        assert FIRST.because not in app.page
        await press(pilot, "a")
        await until_shown(pilot, app, FIRST.because)


# hints and the solution


async def test_hints_come_in_their_order_and_end_with_the_third() -> None:
    Progress().see(WITH_EXERCISE.id)
    assert WITH_EXERCISE.exercise is not None
    first, second, third = WITH_EXERCISE.exercise.hints
    async with console(lesson=WITH_EXERCISE.id) as (app, pilot):
        assert first not in app.page
        await press(pilot, "h")
        assert first in app.page
        assert second not in app.page
        await press(pilot, "h", "h", "h")
        assert third in app.page
        assert app.kept().hints == 3


@pytest.mark.slow
async def test_a_hint_is_told_where_the_page_is_not_in_sight() -> None:
    Progress().see(WITH_EXERCISE.id)
    assert WITH_EXERCISE.exercise is not None
    async with console(2.0, WITH_EXERCISE.id, None, "2", "h") as (app, _):
        assert [note.message for note in app._notifications] == [WITH_EXERCISE.exercise.hints[0]]


@pytest.mark.slow
async def test_no_hint_is_given_before_the_exercise_can_be_read() -> None:
    async with console(lesson=WITH_EXERCISE.id) as (app, pilot):
        await press(pilot, "escape", "h", "H")
        assert top(app) is LessonScreen
        assert app.kept().hints == 0


@pytest.mark.slow
async def test_the_solution_is_shown_when_it_is_wanted_and_asked_about_once() -> None:
    Progress().see(WITH_EXERCISE.id)
    async with console(lesson=WITH_EXERCISE.id) as (app, pilot):
        await press(pilot, "H")
        assert top(app) is ConfirmSolutionScreen
        await press(pilot, "escape")
        assert not app.kept().solution
        await press(pilot, "H", "enter")
        assert top(app) is SolutionScreen
        assert app.kept().solution
        assert "+" in text_of(app)
        await press(pilot, "d")
        assert "The solution: node.py" in text_of(app)
        assert "@@" not in text_of(app)
        await press(pilot, "escape", "H")
        assert top(app) is SolutionScreen


# the file that keeps it


@pytest.mark.slow
async def test_progress_that_cannot_be_read_is_told_of_and_the_lesson_goes_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    (tmp_path / "cbtui" / "progress.jsonl").mkdir(parents=True)
    async with console() as (app, pilot):
        await press(pilot, "1", "enter", "2", "enter")
        assert app.started()
        assert any("progress.jsonl" in note.message for note in app._notifications)
        assert f"> {FIRST.answers[0]}" in app.page
