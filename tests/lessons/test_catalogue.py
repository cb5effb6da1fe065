"""The lessons that are there, their order, and finding one by its id."""

import subprocess
import sys
from itertools import groupby, pairwise

import pytest

from lessons.catalogue import ROOT, UnknownLesson, find, lesson_on, lessons
from lessons.lesson import Lesson, read_lesson

every_lesson = pytest.mark.parametrize("lesson", lessons(), ids=lambda lesson: lesson.id)

KEYS = {"s", "S", "space", "t", "r"}


def test_the_lessons_stand_in_teaching_order() -> None:
    order = [lesson.id for lesson in lessons()]
    assert order[:3] == ["single-thread", "shared-group", "split-groups"]
    assert order.index("call-in-a-callback") < order.index("three-cures") < order.index("two-executors")


def test_the_lessons_are_numbered_without_a_gap_in_the_order_of_the_numbers_they_were_given() -> None:
    # Units leave room between the numbers they give, for lessons to come.
    given = [read_lesson(lesson.folder).number for lesson in lessons()]
    assert given == sorted(set(given))
    assert [lesson.number for lesson in lessons()] == list(range(1, len(lessons()) + 1))


def test_the_lessons_of_a_unit_stand_together() -> None:
    units = [unit for unit, _ in groupby(lesson.unit for lesson in lessons())]
    assert len(units) == len(set(units))


@pytest.mark.parametrize(
    ("problem", "lesson"),
    [
        ("self-made-deadlock", "call-in-a-callback"),
        ("threads-wait-for-lock", "lock-or-group"),
        ("deadlock-over-a-rate", "rate-sleep-in-a-callback"),
        ("deadlock-over-the-clock", "sim-time-in-a-callback"),
        ("lookup-keeps-transform", "lookup-in-a-callback"),
        ("group-starvation", "single-thread"),
        ("group-held-beside-threads", "no-groups-at-all"),
        ("no-free-worker", "reentrant-2-threads"),
        ("one-thread-for-all", "reentrant-1-thread"),
        ("falls-behind", "stale-data"),
        ("exception-swallowed", "lost-exceptions"),
        ("overrun-timer", "missed-ticks"),
    ],
)
def test_a_problem_leads_to_the_lesson_that_shows_its_kind(problem: str, lesson: str) -> None:
    assert lesson_on(problem) == find(lesson)


def test_every_lesson_folder_is_in_the_catalogue() -> None:
    folders = {path.parent for path in ROOT.glob("unit*/*/lesson.toml")}
    assert folders == {lesson.folder for lesson in lessons()}


def test_a_lesson_is_found_by_its_id_and_by_its_number() -> None:
    for lesson in lessons():
        assert find(lesson.id) is lesson
        assert find(str(lesson.number)) is lesson


@pytest.mark.parametrize(
    ("asked", "nearest"),
    [
        ("split-group", "split-groups"),
        ("SINGLE-THREAD", "single-thread"),
        ("reentrant-1-threads", "reentrant-1-thread"),
        ("exclusive", "exclusive-2-threads"),
    ],
)
def test_an_unknown_id_is_answered_with_the_nearest(asked: str, nearest: str) -> None:
    with pytest.raises(UnknownLesson) as caught:
        find(asked)
    assert str(caught.value) == (
        f"no lesson is called '{asked}'; the nearest is '{nearest}', and cbtui list shows all"
    )


@pytest.mark.parametrize("asked", ["", "§", "no such thing\n"])
def test_an_id_like_no_other_gets_one_line_without_a_nearest(asked: str) -> None:
    with pytest.raises(UnknownLesson, match="cbtui list shows all") as caught:
        find(asked)
    assert len(str(caught.value).splitlines()) == 1
    assert "nearest" not in str(caught.value)


def test_a_number_that_no_lesson_has_is_answered_with_how_many_there_are() -> None:
    with pytest.raises(UnknownLesson, match=f"^there are {len(lessons())} lessons, and none is number 999$"):
        find("999")


@every_lesson
def test_a_guide_fits_beside_the_lanes(lesson: Lesson) -> None:
    lines = lesson.guide.splitlines()
    assert lines[0] == f"# {lesson.title}"
    assert 23 <= len(lines) <= 40, f"guide.md has {len(lines)} lines, and 23 to 40 fill its pane"


def test_each_lesson_announces_the_next() -> None:
    for lesson, following in pairwise(lessons()):
        told = f"lesson.toml of {following.id} needs a teaser, which {lesson.id} ends with"
        assert lesson.following == f"*{following.title}*, which {following.teaser}", told
    assert lessons()[-1].following == ""


@every_lesson
def test_what_to_try_names_keys_that_the_guide_names_too(lesson: Lesson) -> None:
    assert lesson.tries
    for tried in lesson.tries:
        assert tried.key in KEYS
        assert f"`{tried.key}`" in lesson.guide


@every_lesson
def test_what_is_read_in_one_line_fits_in_one_line(lesson: Lesson) -> None:
    for text in (lesson.title, lesson.executor, lesson.groups):
        assert len(text) <= 24
    assert len(lesson.teaches) <= 100
    assert lesson.teaches.endswith(".")


def test_listing_the_lessons_imports_nothing_heavy() -> None:
    heavy = {"textual", "rich", "numpy", "rosbags", "pybullet", "attrs", "asyncio"}
    code = f"""
import sys
from lessons.catalogue import lessons
lessons()
print(sorted({heavy!r} & set(sys.modules)))
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
