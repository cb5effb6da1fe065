import subprocess
import sys
from functools import partial
from pathlib import Path

import msgspec
import pytest
from textual.command import CommandList, CommandPalette
from textual.events import Key
from textual.geometry import Size

from cbtui.app import CbtuiApp
from cbtui.screens.choosing import ChoosingScreen
from cbtui.screens.lesson import LessonScreen
from cbtui.screens.menu import MenuScreen
from cbtui.screens.windows.help import HelpScreen
from cbtui.screens.windows.prediction import PredictionScreen
from cbtui.screens.windows.tour import LINE, STOPS, TourScreen
from cbtui.terminal import pending_keys
from cbtui.widgets.description_pane import described, of_lesson
from cbtui.widgets.diagnosis_line import DiagnosisLine
from cbtui.widgets.guide import Guide
from cbtui.widgets.key_bar import KeyBar
from cbtui.widgets.lanes import Lanes
from cbtui.widgets.menu_list import MenuList
from lessons.catalogue import lessons
from lessons.lesson import Lesson
from lessons.progress import Progress
from lessons.puzzles import puzzles, puzzles_of
from tests.support.builder import ns
from tests.support.console import NARROW, TALL, WIDE, predict, settle
from tests.support.daily import first_daily
from tests.support.exercises import until
from tests.support.fake_session import FakeEngines
from tests.support.lesson_runs import shared_group_run
from tests.support.pictures import lines_of, text_of

HEAVY = {"numpy", "pybullet", "rosbags", "pygments", "markdown_it", "multiprocessing", "cbtui.screens.lesson"}


def menu() -> CbtuiApp:
    return CbtuiApp(open_session=FakeEngines([], 0))


def opened(app: CbtuiApp) -> str | None:
    """The lesson that lies over the menu, whatever lies over that."""
    screens = [screen for screen in app.screen_stack if isinstance(screen, LessonScreen)]
    lesson = screens[0].subject.lesson if screens else None
    return None if lesson is None else lesson.id


def high_enough(size: tuple[int, int]) -> tuple[int, int]:
    """A screen of that width at least as high as a line for each lesson, each unit and all around needs."""
    return size[0], max(size[1], 2 * len(lessons()))


async def test_far_keys_go_to_the_first_and_the_last_lesson_and_by_pages() -> None:
    app = menu()
    async with app.run_test(size=NARROW) as pilot:
        chosen = app.screen.query_one(MenuList)
        await pilot.press("end")
        assert chosen.chosen == lessons()[-1]
        await pilot.press("pageup")
        assert chosen.chosen not in (lessons()[0], lessons()[-1])
        await pilot.press("home")
        assert chosen.chosen == lessons()[0]
        await pilot.press("pagedown")
        assert chosen.chosen not in (lessons()[0], lessons()[-1])


@pytest.mark.parametrize("size", first_daily(WIDE, TALL))
async def test_the_menu_shows_every_lesson_under_its_unit(size: tuple[int, int]) -> None:
    app = menu()
    async with app.run_test(size=high_enough(size)):
        lines = lines_of(app)
        for lesson in lessons():
            assert len([line for line in lines if f" {lesson.number}  {lesson.title} " in f"{line} "]) == 1
            assert all(word in text_of(app) for word in f"Unit {lesson.unit}".split())


async def test_a_wide_menu_shows_in_its_list_what_every_lesson_is_made_of() -> None:
    app = menu()
    async with app.run_test(size=high_enough(WIDE)):
        for lesson in lessons():
            (line,) = (line for line in lines_of(app) if f" {lesson.number}  {lesson.title} " in line)
            assert lesson.executor.replace("ThreadedExecutor", "Threaded") in line
            assert lesson.groups in line


@pytest.mark.slow
@pytest.mark.parametrize("size", first_daily(WIDE, NARROW))
async def test_the_menu_tells_what_the_highlighted_lesson_teaches_and_is_made_of(
    size: tuple[int, int],
) -> None:
    for lesson in lessons():
        Progress().see(lesson.id)
    app = menu()
    async with app.run_test(size=size) as pilot:
        for lesson in lessons():
            await pilot.pause()
            text = text_of(app)
            assert all(word in text for word in lesson.teaches.replace("-", " ").split())
            assert lesson.executor in text
            assert lesson.groups in text
            await pilot.press("down", *("down" for _ in puzzles_of(lesson.id)))


async def test_what_a_lesson_teaches_is_not_told_before_it_was_watched() -> None:
    app = menu()
    async with app.run_test(size=WIDE):
        text = text_of(app)
        assert "The robot drives straight on." in text
        assert "One long callback" not in text


async def test_enter_opens_the_highlighted_lesson() -> None:
    app = menu()
    async with app.run_test(size=NARROW) as pilot:
        await pilot.press("down", "down", "up", "enter")
        assert opened(app) == lessons()[1].id


async def test_a_number_opens_its_lesson(monkeypatch: pytest.MonkeyPatch) -> None:
    app, asked = menu(), list[Lesson]()
    monkeypatch.setattr(app, "open_lesson", asked.append)
    async with app.run_test(size=NARROW) as pilot:
        for lesson in lessons()[::6]:
            await pilot.press(*str(lesson.number), *(["enter"] if lesson.number < 4 else []))
            assert asked[-1:] == [lesson]


async def test_an_enter_after_a_number_that_opened_at_once_is_not_for_the_lesson(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(pending_keys, "ENTER_AFTER", 3600.0)
    app = menu()
    predict(app, lessons()[12].id)
    async with app.run_test(size=NARROW) as pilot:
        await pilot.press(*"13", "enter")
        assert opened(app) == lessons()[12].id
        assert isinstance(app.focused, Guide)
        await pilot.press("enter")
        assert isinstance(app.focused, Lanes)


async def test_such_an_enter_may_come_three_seconds_later() -> None:
    app = menu()
    predict(app, lessons()[12].id)
    async with app.run_test(size=NARROW) as pilot:
        await pilot.press(*"13")
        assert opened(app) == lessons()[12].id
        enter = Key("enter", "\r")
        enter.time = app._enter_until - pending_keys.ENTER_AFTER + 3.0
        app.post_message(enter)
        await until(pilot, lambda: not app._enter_until)
        await pilot.pause()
        assert isinstance(app.focused, Guide)


async def test_letters_of_a_name_find_its_lesson() -> None:
    app = menu()
    async with app.run_test(size=NARROW) as pilot:
        await pilot.press(*"stale", "enter")
        assert opened(app) == "stale-data"


async def test_the_menu_invites_to_the_first_lesson_with_something_left_to_do() -> None:
    app = menu()
    async with app.run_test(size=NARROW) as pilot:
        assert "Single thread  ◂ start here" in text_of(app)
        Progress().explain(lessons()[0].id)
        await pilot.press("down", "enter", "q")
        await pilot.press("q")
        assert "One shared group    ◂ go on" in text_of(app)


async def test_the_invitation_does_not_read_as_one_with_the_executor_beside_it() -> None:
    app = menu()
    async with app.run_test(size=WIDE):
        assert "Single thread  ◂ start   rclpy.spin" in text_of(app)


async def test_a_lesson_that_is_not_predicted_gives_nothing_away() -> None:
    app = menu()
    lesson = lessons()[0]
    async with app.run_test(size=WIDE) as pilot:
        await pilot.pause()
        told = " ".join(text_of(app).split())
        assert "its first question" in told
        assert not any(attempt.text in told for attempt in lesson.tries)
        assert lesson.predictions[0].question[:20] in told


def test_in_few_rows_a_description_leaves_out_no_progress() -> None:
    progress = "predicted, not watched yet: run it for 30 s or to its end"
    about = of_lesson(
        lessons()[0], "The robot drives straight on, and turns for ten seconds.", 0, 9.0, progress
    )
    rows = [" ".join(run.text.strip() for run in row) for row in described(about, Size(36, 9))[:9]]
    assert "end" in " ".join(rows)
    assert "" not in rows
    assert "" in [row[0].text.strip() for row in described(about, Size(36, 20))]


async def test_the_heading_of_a_question_is_set_off_from_its_line() -> None:
    app = menu()
    async with app.run_test(size=NARROW) as pilot:
        await pilot.pause()
        assert "─ its first question ─" in text_of(app)


async def test_any_key_leaves_the_tour_for_the_predictions() -> None:
    app = menu()
    async with app.run_test(size=NARROW) as pilot:
        await pilot.press("T")
        await until(pilot, lambda: isinstance(app.screen, TourScreen))
        assert opened(app) == lessons()[0].id
        await pilot.press("x")
        await until(pilot, lambda: isinstance(app.screen, PredictionScreen))
        assert not Progress().of(lessons()[0].id).seen


async def test_keys_turn_the_pages_of_the_tour_and_its_last_page_ends_it() -> None:
    app = menu()
    async with app.run_test(size=NARROW) as pilot:
        await pilot.press("T")
        await until(pilot, lambda: isinstance(app.screen, TourScreen))
        assert "⏎ next  ← back" in text_of(app)
        assert "goes on by itself in 6 s" in text_of(app)
        for key, page in (("left", 1), ("enter", 2), ("right", 3), ("left", 2)):
            await pilot.press(key)
            assert f"Tour {page}/{len(STOPS)}" in text_of(app)
        await pilot.click(KeyBar, offset=(2, 0))
        assert f"Tour 3/{len(STOPS)}" in text_of(app)
        await pilot.press(*["space"] * (len(STOPS) - 4))
        assert "goes on by itself in" in text_of(app)
        await pilot.press("space")
        assert "ends by itself in" in text_of(app)
        await pilot.press("space")
        await until(pilot, lambda: isinstance(app.screen, PredictionScreen))


@pytest.mark.parametrize("size", [NARROW, WIDE])
async def test_the_tour_covers_neither_what_it_tells_of_nor_the_line_above_the_keys(
    size: tuple[int, int],
) -> None:
    app = CbtuiApp(open_session=FakeEngines(shared_group_run().events, ns(2.0)))
    async with app.run_test(size=size) as pilot:
        await pilot.press("T")
        await until(pilot, lambda: isinstance(app.screen, TourScreen))
        for stop in STOPS:
            lesson = app.screen_stack[-2]
            await until(pilot, lambda: lesson.query_one(Lanes).region.height > 6)  # noqa: B023 it is the same
            await settle(pilot)
            window = app.screen.query_one(".window").region
            line = lesson.query_one(DiagnosisLine)
            assert line.region.height == 1
            assert line.has_class("-shown") is (stop.place == LINE)
            told = {LINE: line, "lanes": lesson.query_one(Lanes)}.get(stop.place)
            for place in (line, told or lesson.query_one(f"#{stop.place}")):
                assert place.region
                assert not window.overlaps(place.region)
            await pilot.press("enter")


def test_no_page_of_the_tour_turns_faster_than_one_reads() -> None:
    assert all(len(stop.text.split()) / stop.seconds <= 3 for stop in STOPS)


def test_the_tour_promises_no_exercise_that_its_lesson_may_lack() -> None:
    [told] = [stop.text for stop in STOPS if "exercise" in stop.text]
    assert "if it has one" in told


def test_the_tour_does_not_say_that_a_node_runs_which_is_being_started() -> None:
    assert "runs now" not in STOPS[0].text
    assert "starts now" in STOPS[0].text


async def test_the_number_of_no_lesson_does_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("cbtui.app.lessons", lambda: lessons()[:8])
    app = menu()
    async with app.run_test(size=NARROW) as pilot:
        await pilot.press("9")
        assert isinstance(app.screen, MenuScreen)


async def test_a_click_opens_a_lesson() -> None:
    app = menu()
    async with app.run_test(size=NARROW) as pilot:
        row = next(row for row, line in enumerate(lines_of(app)) if lessons()[2].title in line)
        top = app.screen.query_one(MenuList).region.y
        await pilot.click(MenuList, offset=(10, row - top))
        assert opened(app) == lessons()[2].id


@pytest.mark.slow
async def test_a_click_on_a_key_does_what_the_key_does() -> None:
    app = menu()
    async with app.run_test(size=NARROW) as pilot:
        column = lines_of(app)[-1].index("? help")
        await pilot.click(KeyBar, offset=(column, 0))
        assert isinstance(app.screen, HelpScreen)


@pytest.mark.slow
async def test_leaving_a_lesson_comes_back_to_where_it_was_opened() -> None:
    app = menu()
    async with app.run_test(size=NARROW) as pilot:
        await pilot.press("4", "q")
        await until(pilot, lambda: isinstance(app.screen, MenuScreen))
        await pilot.press("enter")
        assert opened(app) == lessons()[3].id


@pytest.mark.slow
async def test_leaving_the_lesson_after_comes_back_to_that() -> None:
    app = menu()
    predict(app, lessons()[3].id)
    async with app.run_test(size=NARROW) as pilot:
        await pilot.press("4")
        await until(pilot, lambda: opened(app) == lessons()[3].id)
        await pilot.press("n")
        await until(pilot, lambda: isinstance(app.screen, PredictionScreen))
        await pilot.press("q")
        await until(pilot, lambda: isinstance(app.screen, MenuScreen))
        await pilot.press("enter")
        assert opened(app) == lessons()[4].id


async def test_q_leaves_the_console() -> None:
    app = menu()
    async with app.run_test(size=NARROW) as pilot:
        await pilot.press("q")
        assert not app.is_running


@pytest.mark.slow
async def test_the_palette_finds_a_command_of_the_screen() -> None:
    app = menu()
    async with app.run_test(size=WIDE) as pilot:
        await pilot.press("ctrl+p", *"lesson 5")
        await until(pilot, lambda: is_the_palettes_first(app, "Open lesson  5: Reentrant, 2 threads"))
        await pilot.press("enter", "enter")
        while opened(app) is None:
            await pilot.pause(0.02)
        assert opened(app) == lessons()[4].id


def is_the_palettes_first(app: CbtuiApp, command: str) -> bool:
    """Whether the palette, once it has found what it looked for, has this command first."""
    palette = app.screen
    assert isinstance(palette, CommandPalette)
    commands = palette.query_one(CommandList)
    searches = [each for each in palette.workers if each.group == CommandPalette._GATHER_COMMANDS_GROUP]
    return (
        bool(commands.option_count)
        and all(each.is_finished for each in searches)
        and command in str(commands.get_option_at_index(0).prompt)
    )


def many_lessons() -> tuple[Lesson, ...]:
    return tuple(
        msgspec.structs.replace(
            lessons()[0], id=f"lesson-{number}", number=number, title=f"Title {number}", unit=f"{number // 7}"
        )
        for number in range(1, 28)
    )


@pytest.mark.parametrize("size", first_daily(WIDE, NARROW))
async def test_a_list_that_is_too_long_goes_with_the_highlight(
    size: tuple[int, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("cbtui.app.lessons", many_lessons)
    app = menu()
    async with app.run_test(size=size) as pilot:
        assert "Title 27" not in text_of(app)
        await pilot.press("up")
        await pilot.pause()
        assert "27  Title 27" in text_of(app)
        await pilot.press("down")
        await pilot.pause()
        assert "1  Title 1 " in text_of(app)


# progress


@pytest.mark.slow
async def test_a_lesson_that_was_opened_has_a_mark_in_the_next_console_too() -> None:
    first, second, *_ = lessons()
    app = menu()
    async with app.run_test(size=NARROW) as pilot:
        assert f"·  1  {first.title}" in text_of(app)
        await pilot.press("1", "enter", "q")
        await until(pilot, lambda: isinstance(app.screen, MenuScreen))
        assert f"○  1  {first.title}" in text_of(app)
    app = menu()
    async with app.run_test(size=NARROW):
        text = text_of(app)
        assert f"○  1  {first.title}" in text
        assert f"·  2  {second.title}" in text
        assert "opened    just now" in text


@pytest.mark.slow
async def test_a_home_that_cannot_be_written_is_told_of_and_nothing_else_changes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "state").write_text("")
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    app = menu()
    async with app.run_test(size=NARROW) as pilot:
        await pilot.press("1", "enter", "q", "2", "enter", "q")
        assert [note.severity for note in app._notifications] == ["warning"]
        assert isinstance(app.screen, MenuScreen)


@pytest.mark.slow
def test_nothing_heavy_is_imported_before_the_menu_is_shown() -> None:
    program = """
import asyncio, sys
from cbtui.app import CbtuiApp
async def main():
    app = CbtuiApp()
    async with app.run_test(size=(80, 24)):
        print(*sys.modules)
asyncio.run(main())
"""
    shown = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert HEAVY & set(shown.stdout.split()) == set()


async def test_the_menu_begins_at_the_lesson_to_go_on_with() -> None:
    first, second = lessons()[:2]
    for place in range(len(first.predictions)):
        Progress().answer(first.id, place, 0)
    Progress().see(first.id)
    Progress().explain(first.id)
    app = menu()
    async with app.run_test(size=NARROW):
        assert app.screen.query_one(MenuList).chosen == second


@pytest.mark.slow
async def test_marks_tell_how_far_the_learner_is_in_each_lesson() -> None:
    plain, exercised = lessons()[0], next(lesson for lesson in lessons() if lesson.exercise is not None)
    app = menu()
    progress = Progress()

    def answer_all(lesson: Lesson) -> None:
        for place in range(len(lesson.predictions)):
            progress.answer(lesson.id, place, 0)

    async with app.run_test(size=WIDE) as pilot:
        told = []
        for change in (
            partial(answer_all, exercised),
            partial(progress.see, exercised.id),
            partial(progress.passes, exercised.id),
            partial(progress.explain, exercised.id),
        ):
            change()
            await pilot.press("question_mark", "escape")
            await pilot.pause()
            told.append(next(line for line in lines_of(app) if exercised.title in line).split()[1])
        assert told == ["◐", "●", "●", "✓"]
        answer_all(plain)
        progress.see(plain.id)
        progress.explain(plain.id)
        await pilot.press("question_mark", "escape")
        await pilot.pause()
        assert "so far" in text_of(app)
        assert "✓ done" in text_of(app)
        unit = [lesson for lesson in lessons() if lesson.unit == plain.unit]
        assert f"multithreading 2/{len(unit)}" in text_of(app)


async def test_progress_that_cannot_be_read_is_told_of_in_the_menu(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    (tmp_path / "cbtui").mkdir()
    (tmp_path / "cbtui" / "progress.jsonl").write_text("no progress\n")
    app = menu()
    async with app.run_test(size=NARROW) as pilot:
        await pilot.pause()
        (note,) = app._notifications
        assert "progress.jsonl:1 is no progress" in note.message


# puzzles


@pytest.mark.slow
async def test_a_puzzle_stands_below_its_lesson_and_opens_with_how_far_it_has_come() -> None:
    puzzle = puzzles_of("lock-or-group")[0]
    Progress().look_at_solution(puzzle.id)
    app = menu()
    async with app.run_test(size=high_enough(NARROW)) as pilot:
        lines = lines_of(app)
        at = next(row for row, line in enumerate(lines) if "Lock or group" in line)
        assert f"●     ? {puzzle.title}" in lines[at + 1]
        assert all(any(f"? {each.title}" in line for line in lines) for each in puzzles())
        await pilot.press("/", *"puzzle sell seat")
        await pilot.pause()
        assert "Sell the last seat twice" in text_of(app)
        assert "Reentrant, 2 threads" in text_of(app)
        await pilot.press("enter")
        await until(pilot, lambda: isinstance(app.screen, ChoosingScreen))
