"""The search of the menu."""

import re
from pathlib import Path

import pytest
from textual.events import Key
from textual.screen import Screen

from cbtui.app import CbtuiApp
from cbtui.runs.setup.recent import RecentEntry, RecentKind, RecentList
from cbtui.screens.lesson import LessonScreen
from cbtui.screens.menu import MenuScreen
from cbtui.screens.windows.open_file import OpenFileScreen
from cbtui.widgets.menu_list import MenuList
from cbtui.widgets.menu_search import MenuSearch
from lessons.lesson import Lesson
from tests.support.console import NARROW, TALL, predict
from tests.support.exercises import until
from tests.support.fake_session import FakeEngines
from tests.support.pictures import text_of


def menu() -> CbtuiApp:
    return CbtuiApp(open_session=FakeEngines([], 0))


@pytest.fixture
def program(tmp_path: Path) -> Path:
    path = tmp_path / "my_node.py"
    path.write_text("pass\n")
    RecentList().note(RecentEntry(RecentKind.PROGRAM, str(path), 100))
    return path


async def test_words_show_only_what_has_them_and_escape_shows_all(program: Path) -> None:
    app = menu()
    async with app.run_test(size=TALL) as pilot:
        await pilot.press("slash", *"THREADS reen")
        await pilot.pause()
        text = text_of(app)
        assert "Reentrant, 2 threads" in text
        assert "Split groups" not in text
        assert "my_node.py" not in text
        await pilot.press("escape")
        await pilot.pause()
        assert "Split groups" in text_of(app)
        assert "my_node.py" in text_of(app)
        assert not app.screen.query(MenuSearch)


async def test_a_title_is_chosen_and_what_only_has_the_words_somewhere_is_hidden() -> None:
    app = menu()
    async with app.run_test(size=TALL) as pilot:
        await pilot.press("slash", *"call in")
        await pilot.pause()
        chosen = app.screen.query_one(MenuList).chosen
        assert isinstance(chosen, Lesson)
        assert chosen.id == "call-in-a-callback"
        assert "Single thread" not in text_of(app)


async def test_what_is_found_stands_below_the_heading_of_its_unit_in_the_order_of_the_course() -> None:
    app = menu()
    async with app.run_test(size=TALL) as pilot:
        await pilot.press("slash", *"wait")
        await pilot.pause()
        units = [int(unit) for unit in re.findall(r"Unit (\d+) ", text_of(app))]
        assert units == sorted(set(units))
        chosen = app.screen.query_one(MenuList).chosen
        assert isinstance(chosen, Lesson)
        assert "wait" in chosen.title


@pytest.mark.parametrize(
    ("typed", "titles"),
    [
        ("single", ["Single thread", "One shared group"]),
        ("deadlock", ["Call in a callback", "Service in a service"]),
    ],
)
async def test_what_is_found_by_its_text_or_by_the_problem_it_shows_is_shown_too(
    typed: str, titles: list[str]
) -> None:
    app = menu()
    async with app.run_test(size=TALL) as pilot:
        await pilot.press("slash", *typed)
        await pilot.pause()
        assert all(title in text_of(app) for title in titles)


async def test_a_search_begins_anew_after_a_lesson(program: Path) -> None:
    app = menu()
    async with app.run_test(size=NARROW) as pilot:
        await pilot.press("slash", *"split")
        app.push_screen(Screen())
        await pilot.pause()
        app.pop_screen()
        await pilot.pause()
        await pilot.press("o")
        assert isinstance(app.screen, OpenFileScreen), "letters are keys again, and no words to look for"
        await pilot.press("escape", "slash", *"my_n")
        await pilot.pause()
        assert [each.value for each in app.screen.query(MenuSearch)] == ["my_n"]
        assert "my_node.py" in text_of(app)


async def test_digits_typed_at_once_open_their_lesson() -> None:
    app = menu()
    async with app.run_test(size=NARROW) as pilot:
        type_at_once(app, "13")
        await until(
            pilot, lambda: "Spin inside a callback" in text_of(app) and app.screen is not menu_of(app)
        )


async def test_letters_typed_at_once_are_all_looked_for_even_those_of_keys() -> None:
    app = menu()
    async with app.run_test(size=NARROW) as pilot:
        type_at_once(app, "unlock")
        await until(pilot, lambda: [each.value for each in app.screen.query(MenuSearch)] == ["unlock"])


def type_at_once(app: CbtuiApp, characters: str) -> None:
    for character in characters:
        app.post_message(Key(character, character))


def menu_of(app: CbtuiApp) -> Screen[None]:
    return app.screen_stack[0]


@pytest.mark.slow
async def test_digits_are_words_too_and_enter_opens_what_is_highlighted() -> None:
    app = menu()
    predict(app, "reentrant-2-threads")
    async with app.run_test(size=NARROW) as pilot:
        await pilot.press("slash", *"2 threads", "down")
        await pilot.press("enter")
        assert isinstance(app.screen, LessonScreen)
        assert app.screen.subject.lesson is not None
        assert app.screen.subject.lesson.id == "reentrant-2-threads"


@pytest.mark.slow
async def test_a_search_stays_when_a_lesson_is_left_until_it_is_ended() -> None:
    app = menu()
    async with app.run_test(size=NARROW) as pilot:
        await pilot.press("slash", *"split", "enter", "q")
        await pilot.pause()
        assert "One shared group" not in text_of(app)
        await pilot.press("escape")
        await pilot.pause()
        assert "One shared group" in text_of(app)


async def test_recent_files_are_found_by_their_paths(program: Path) -> None:
    app = menu()
    async with app.run_test(size=NARROW) as pilot:
        await pilot.press("slash", *"my_n")
        await pilot.pause()
        assert "my_node.py" in text_of(app)
        assert "Unit" not in text_of(app)


async def test_words_that_nothing_has_are_said_to_find_nothing() -> None:
    app = menu()
    async with app.run_test(size=NARROW) as pilot:
        await pilot.press("slash", *"zebra", "enter", "down", "up")
        await pilot.pause()
        assert "No lesson or recent file has all of" in text_of(app)
        assert isinstance(app.screen, MenuScreen)


async def test_a_search_without_words_goes_when_it_is_left() -> None:
    app = menu()
    async with app.run_test(size=NARROW) as pilot:
        await pilot.press("slash", "tab")
        await pilot.pause()
        assert not app.screen.query(MenuSearch)
