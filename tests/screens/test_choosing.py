"""The learner is the scheduler: in a puzzle, and from a moment of a paused run on."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest
from textual.pilot import Pilot
from textual.widgets import Static

from cbtui.app import CbtuiApp
from cbtui.screens.choosing import ChoosingScreen
from cbtui.screens.lesson import LessonScreen
from cbtui.screens.parts.choices import Choices
from cbtui.screens.run import RunScreen
from cbtui.widgets.choice import ChoiceSheet, ChoiceView, kept_of, options_of
from cbtui.widgets.code import CodeView
from cbtui.widgets.key_bar import KeyBar
from lessons.progress import Progress
from lessons.puzzles import Puzzle, puzzles
from sim.engine.commands import Choose, Resume
from sim.trace.events import ChoiceAsked, Reason
from sim.trace.model import Nanoseconds
from sim.trace.timeline import Timeline
from tests.support.asking import PUZZLE, Asking, question
from tests.support.builder import Run, ns
from tests.support.console import NARROW, WIDE, settle
from tests.support.exercises import until
from tests.support.pictures import lines_of, text_of


def console(sessions: Callable[..., object] | None, puzzle: Puzzle = PUZZLE) -> CbtuiApp:
    app = CbtuiApp(start_puzzle=puzzle, open_session=sessions)  # type: ignore[arg-type]
    app.animation_level = "none"
    return app


def news(app: CbtuiApp) -> str:
    return app.screen.query_one(ChoiceView).sheet.news


def choices_of(app: CbtuiApp) -> Choices:
    assert isinstance(app.screen, ChoosingScreen)
    return app.screen._choices


def offered(app: CbtuiApp) -> set[str]:
    return {action.id for action in app.screen.query_one(KeyBar).working()}


def shown_keys(app: CbtuiApp) -> set[str]:
    return {action.name for action in app.screen.query_one(KeyBar).offered}


async def test_who_may_go_on_is_asked_and_shown_in_the_code() -> None:
    app = console(Asking())
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        text = text_of(app)
        assert PUZZLE.task.split(".")[0] in " ".join(text.split("│")[0].split()) or "keeps one" in text
        assert "Choice 1, 0 moves. Who goes on?" in text
        assert app.screen.query_one(ChoiceView).sheet.task.endswith("A move is a choice other than 1.")
        assert "1 order, line 20 (runs now," in text
        assert "2 Pool-0_1 looks for work" in text
        assert app.screen.query_one(CodeView).picked == 20
        assert lines_of(app)[-2].startswith(" · time stands still until you choose who goes on")
        assert any("self.sent.publish" in line or "publish" in line for line in lines_of(app))
        assert {"take", "resume", "solution", "lesson", "run_again"} <= offered(app)
        assert not {"undo", "step", "pause"} & offered(app)


async def test_the_help_has_in_brackets_what_the_pane_with_the_focus_uses_for_something_else() -> None:
    app = console(Asking())
    async with app.run_test(size=WIDE) as pilot:
        await settle(pilot)
        await pilot.press("question_mark")
        await until(pilot, lambda: "Choice of who goes on" in text_of(app))
        rows = "\n".join(
            str(app.screen.query_one(f"#{each}", Static).render()) for each in ("found", "beside")
        )
        assert re.search(r" 1-9 +Let the thread with this number", rows)
        assert re.search(r" \(1-6\) +Go to a pane", rows)


async def test_the_code_marks_the_line_of_each_thread_that_may_be_chosen_now() -> None:
    def marked() -> list[str]:
        return [line for line in lines_of(app) if "20 ▶ " in line]

    app = console(Asking())
    async with app.run_test(size=WIDE) as pilot:
        await settle(pilot)
        [line] = marked()
        assert "▶ 1 Pool-0_0" in line
        await pilot.press("left_square_bracket")
        await settle(pilot)
        assert not marked()  # in the past nothing is chosen
        await pilot.press("0", "space")
        await settle(pilot)
        assert not marked()


async def test_a_key_without_effect_on_a_puzzle_says_why() -> None:
    app = console(Asking())
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        for key in ("t", "s", "full_stop", "h"):
            app.clear_notifications()
            await pilot.press(key)
            [note] = app._notifications
            assert note.message.startswith("Here you only choose") or key == "full_stop"
            assert "pauses" not in note.message


async def test_choices_are_moves_until_the_goal_is_reached_which_is_kept() -> None:
    sessions = Asking()
    app = console(sessions)
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        await pilot.press("2")
        await settle(pilot)
        assert news(app) == "Choice 2, 1 move. Who goes on?"
        await pilot.press("9", "down", "enter")  # there is no ninth
        await settle(pilot)
        assert sessions.latest.commands == [Choose(1), Choose(1)]
        assert news(app) == "✓ Done in 2 moves; the solution takes 2."
        assert Progress().of(PUZZLE.id).passed


async def test_whoever_looks_back_is_brought_to_the_present_before_anything_is_chosen() -> None:
    sessions = Asking()
    app = console(sessions)
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        navigation = shown(app).navigation
        for key in ("1", "9", "enter"):
            app.clear_notifications()
            await pilot.press("left_square_bracket")
            assert navigation.playhead.at is not None
            await pilot.press(key)
            await settle(pilot)
            assert not sessions.latest.commands
            assert navigation.now == navigation.end()
            assert [note.message[:22] for note in app._notifications] == ["Nothing is chosen yet:"]
        await pilot.press("1")
        await settle(pilot)
        assert sessions.latest.commands == [Choose(0)]


async def test_keys_that_come_before_their_choices_are_kept_in_order() -> None:
    sessions = Asking(questions=4)
    app = console(sessions)
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        choosing = choices_of(app)
        for option in (1, 0, 1):
            choosing.choose(option)
        assert sessions.latest.commands == [Choose(1)]
        await settle(pilot)
        assert sessions.latest.commands == [Choose(1), Choose(0), Choose(1)]
        assert news(app) == "Choice 4, 2 moves. Who goes on?"


async def test_the_key_bar_offers_choosing_only_while_something_is_asked() -> None:
    app = console(Asking())
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        assert "1-9 choose" in lines_of(app)[-1]
        assert "show_pane" not in {each.name for each in app.screen.query_one(KeyBar).offered}
        await pilot.press("space")
        await settle(pilot)
        assert "choose" not in lines_of(app)[-1]
        assert "show_pane" not in {each.name for each in app.screen.query_one(KeyBar).offered}
        await pilot.press("tab")
        await settle(pilot)
        assert "show_pane" in {each.name for each in app.screen.query_one(KeyBar).offered}


async def test_a_key_that_is_too_early_is_taken_back_before_a_choice_is() -> None:
    sessions = Asking(questions=4)
    app = console(sessions)
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        choosing = choices_of(app)
        choosing.choose(1)
        choosing.choose(0)
        await choosing.action_undo()
        await settle(pilot)
        assert len(sessions.sessions) == 1
        assert news(app) == "Choice 2, 1 move. Who goes on?"
        await choosing.action_undo()
        choosing.choose(0)
        await settle(pilot)
        assert len(sessions.sessions) == 2
        assert news(app) == "Choice 2, 0 moves. Who goes on?"


@pytest.mark.parametrize("looks_back", [False, True])
async def test_a_number_of_no_pane_after_the_end_is_told_that_the_run_is_over(looks_back: bool) -> None:
    app = console(Asking())
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        await pilot.press("1", "1")
        await settle(pilot)
        await pilot.press(*["left_square_bracket"] * looks_back, "8")
        await settle(pilot)
        assert [note.message for note in app._notifications] == ["The run is over: r begins again."]


async def test_nothing_is_chosen_before_the_first_question_is_on_screen() -> None:
    sessions = Asking()
    app = console(sessions)
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        choosing, asked = choices_of(app), choices_of(app).question
        assert asked is not None
        choosing.question, choosing.was_asked = None, False
        await pilot.press("1")
        await settle(pilot)
        choosing.take([asked])
        await settle(pilot)
        assert not sessions.latest.commands
        assert [note.message for note in app._notifications] == ["Nothing is asked yet."]


async def test_of_a_held_key_few_are_kept_and_a_choice_that_is_not_there_ends_them() -> None:
    sessions = Asking(questions=20)
    app = console(sessions)
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        choosing = choices_of(app)
        for _ in range(15):
            choosing.choose(0)
        await settle(pilot)
        assert len(sessions.latest.commands) == 10
        for option in (0, 8, 0):
            choosing.choose(option)
        await settle(pilot)
        assert len(sessions.latest.commands) == 11
        assert [note.message for note in app._notifications] == ["There is no thread 9 to choose now."]


async def test_a_goal_that_is_reached_is_at_no_moment_said_to_be_missed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    told, show = [], ChoiceView.show

    def telling(view: ChoiceView, sheet: ChoiceSheet) -> None:
        told.append(sheet.news)
        show(view, sheet)

    monkeypatch.setattr(ChoiceView, "show", telling)
    app = console(Asking())
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        await pilot.press("2")
        await settle(pilot)
        await pilot.press("2")
        await settle(pilot)
    assert told[-1].startswith("✓ Done")
    assert not any(news.startswith("✗") for news in told)


async def test_a_choice_is_taken_back_by_a_run_up_to_it() -> None:
    sessions = Asking()
    app = console(sessions)
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        await pilot.press("2", "1")
        await settle(pilot)
        assert news(app) == "✗ Not this time. u takes a choice back, r begins again."
        await pilot.press("u")
        await until(pilot, lambda: len(sessions.sessions) == 2)
        await settle(pilot)
        assert sessions.latest.setup.seed == "ask:0=1"
        assert news(app) == "Choice 2, 1 move. Who goes on?"
        await pilot.press("r")
        await until(pilot, lambda: len(sessions.sessions) == 3)
        assert sessions.latest.setup.seed == "ask:"
        assert not Progress().of(PUZZLE.id).passed


@pytest.mark.parametrize("second", ["1", "2"])
async def test_after_the_end_of_a_puzzle_numbers_lead_to_panes(second: str) -> None:
    app = console(Asking())
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        assert "show_pane" not in shown_keys(app)
        await pilot.press("2")
        await settle(pilot)
        await pilot.press(second)
        await settle(pilot)
        assert "show_pane" in shown_keys(app)
        assert "choose" not in shown_keys(app)
        assert ("the goal is reached; r begins again" in lines_of(app)[-2]) is (second == "2")
        for number, pane in (("2", "code"), ("7", "choice"), ("1", "guide")):
            await pilot.press(number)
            assert shown(app).panes.current == pane


async def test_the_rest_goes_on_by_itself_when_wanted() -> None:
    sessions = Asking()
    app = console(sessions)
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        await pilot.press("space")
        await settle(pilot)
        assert sessions.latest.commands == [Resume()]
        await pilot.press("1")
        assert sessions.latest.commands == [Resume()]


async def test_the_solution_is_shown_choice_by_choice_and_solves_nothing() -> None:
    sessions = Asking(questions=3)
    app = console(sessions)
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        await pilot.press("H")
        await until(pilot, lambda: len(sessions.sessions) == 2)
        for advised in (0, 1, 1):  # moves:1=1,2=1
            await settle(pilot)
            assert f"The solution chooses {advised + 1}." in news(app)
            await pilot.press("enter")
        assert sessions.latest.commands == [Choose(0), Choose(1), Choose(1)]
        assert Progress().of(PUZZLE.id).solution
        assert not Progress().of(PUZZLE.id).passed


def test_it_is_told_why_the_others_may_not_go_on() -> None:
    run = Run()
    thread, node = run.thread("ThreadPoolExecutor-0_0"), run.node("/node")
    shared = run.exclusive(node)
    slow, quick = run.timer(shared, "slow", 1.0), run.timer(shared, "quick", 1.0)
    run.timer(run.exclusive(node), "idle", 1.0)
    ready = run.timer(run.exclusive(node), "ready", 1.0)
    run.start(slow, thread, 0.1)
    run.wait(quick, 0.1, reason=Reason.GROUP_HELD, holder=slow)
    run.wait(ready, 0.1, reason=Reason.NO_FREE_WORKER)
    timeline = Timeline()
    timeline.extend(run.events)
    crossed = "ThreadPoolExecutor-0_2 waits for self.lock, which ThreadPoolExecutor-0_3 took"
    asked = question(0, ("MainThread (node.py:9, in main) waits for time or work", crossed))
    assert [*kept_of(asked, timeline)] == [
        "quick is ready: group A held by slow",
        "ready is ready for a thread that looks for work",
        "MainThread (node.py:9, in main) waits for time or work",
        "Pool-0_2 waits for self.lock, which Pool-0_3 took",
        "not ready, or about to begin: idle",
    ]
    assert [(option.text, option.line) for option in options_of(asked, timeline)] == [
        ("slow in order, line 20 (runs now, Pool-0_0)", 20),
        ("Pool-0_1 looks for work", 0),
    ]


def test_a_callback_whose_last_line_is_done_ends_and_does_not_begin() -> None:
    run = Run()
    thread = run.thread("ThreadPoolExecutor-0_0")
    group = run.reentrant(run.node("/node"))
    run.start(run.timer(group, "left", 1.0), thread, 0.1)
    run.timer(group, "right", 1.0)
    timeline = Timeline()
    timeline.extend(run.events)
    pool = ("ThreadPoolExecutor-0_0", "ThreadPoolExecutor-0_1")
    asked = ChoiceAsked(ns(0.1), 2, pool, ("", ""), (("", 0), ("", 0)), True, (), (0,))
    assert [option.text for option in options_of(asked, timeline)] == [
        "left returns, or raises (runs now, Pool-0_0)",
        "Pool-0_1 begins",
    ]
    assert [*kept_of(asked, timeline)] == ["not ready, or about to begin: right"]
    alone = ChoiceAsked(ns(0.1), 2, pool[:1], ("",), (("", 0),), True, (), (0,))
    assert [*kept_of(alone, timeline)] == ["not ready when the executor last looked: right"]


async def choose(pilot: Pilot[None], key: str, after: int) -> None:
    """Press a key at the choice with a number from 1, once it is asked."""
    await until(pilot, lambda: news(pilot.app).startswith(f"Choice {after}, "))  # type: ignore[arg-type]
    await pilot.press(key)


@pytest.mark.slow
async def test_a_puzzle_is_solved_on_an_engine_after_a_choice_was_taken_back() -> None:
    app = console(None, next(puzzle for puzzle in puzzles() if puzzle.id == "two-locks"))
    async with app.run_test(size=WIDE) as pilot:
        for number, key in enumerate("11u", start=1):
            await choose(pilot, key, number)
        for number, key in enumerate("22", start=2):
            await choose(pilot, key, number)
        for number in (4, 5, 6):
            await choose(pilot, "1", number)
        await until(pilot, lambda: "✓" in news(app))
        assert "✓ Done in 2 moves; the solution takes 2." in text_of(app)
        assert Progress().of("two-locks").passed


@pytest.mark.slow
async def test_all_choices_can_be_typed_at_once_and_what_was_raised_is_told_at_the_end() -> None:
    app = console(None, next(puzzle for puzzle in puzzles() if puzzle.id == "closed-meanwhile"))
    async with app.run_test(size=WIDE) as pilot:
        await choose(pilot, "1", 1)
        await pilot.press(*"221211")
        await until(pilot, lambda: "✓" in news(app))
        raised = "write raised AssertionError: closed meanwhile"
        assert news(app) == f"✓ Done in 3 moves; the solution takes 3. {raised}."
        await until(pilot, lambda: not choices_of(app).runs.run.alive)
        await until(pilot, lambda: "1 problem" in text_of(app))


MINE = """
import rclpy
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node

rclpy.init()
node = Node("mine")
node.n = 0

def count():
    n = node.n
    node.n = n + 1

node.create_timer(0.5, count)
executor = MultiThreadedExecutor(2)
executor.add_node(node)
executor.spin()
"""


@pytest.mark.slow
async def test_on_a_paused_run_the_learner_becomes_the_scheduler_and_goes_back(tmp_path: Path) -> None:
    file = tmp_path / "mine.py"
    file.write_text(MINE)
    app = CbtuiApp(start_file=(file, (), "virtual"))
    async with app.run_test(size=NARROW) as pilot:
        await until(pilot, lambda: bool(shown(app).runs.timeline.entities))
        assert "take_over" not in offered(app)
        await pilot.press("space")
        await until(pilot, lambda: "take_over" in offered(app))
        before = await where_it_stands(pilot, app)
        await pilot.press("W")
        await until(pilot, lambda: isinstance(app.screen, ChoosingScreen))
        await until(pilot, lambda: news(app).startswith("Choice 1, "))
        assert shown(app).runs.timeline.end >= before
        assert "lesson" not in offered(app)
        await choose(pilot, "2", 1)
        await until(pilot, lambda: news(app).startswith("Choice 2, 1 move"))
        await pilot.press("q")
        await until(pilot, lambda: isinstance(app.screen, LessonScreen))
        assert shown(app).runs.timeline.end == before


async def where_it_stands(pilot: Pilot[None], app: CbtuiApp) -> Nanoseconds:
    """The end of the paused run, once what it said before the pause has come."""
    before = -1
    while before != (end := shown(app).runs.timeline.end):
        before = end
        await pilot.pause(0.5)
    return end


def shown(app: CbtuiApp) -> RunScreen[object]:  # type: ignore[type-var]
    """The run's screen that is on top."""
    assert isinstance(app.screen, RunScreen)
    return app.screen
