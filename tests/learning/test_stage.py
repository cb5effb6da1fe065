"""What the menu says of a lesson that is not done."""

import pytest

from cbtui.learning.stage import Stage, next_lesson, stage_note
from lessons.catalogue import find, lessons
from lessons.progress import LessonProgress


@pytest.mark.parametrize(
    ("lesson", "missing"),
    [
        ("cancel-never-served", "run it for 16 s with a call of /fetch, or to its end, or have it explained"),
        ("qos-never-matches", "run it for 20 s or to its end, or have it explained"),
    ],
)
def test_what_makes_a_lesson_watched_is_told_where_it_is_missing(lesson: str, missing: str) -> None:
    note = stage_note(find(lesson), LessonProgress(lesson=lesson), Stage.PREDICTED)
    assert note.text == f"◐ predicted, not watched yet: {missing}"


def test_a_learner_goes_on_with_the_lesson_that_was_begun_and_else_with_the_first_one_that_is_left() -> None:
    first, second, *_, last = every = lessons()
    stages = {**dict.fromkeys((each.id for each in every), Stage.UNTOUCHED), first.id: Stage.WATCHED}
    assert next_lesson(every, stages) is second
    assert next_lesson(every, {**stages, last.id: Stage.OPENED}) is second
    assert next_lesson(every, {**stages, last.id: Stage.PREDICTED}) is last
    assert next_lesson(every, dict.fromkeys(stages, Stage.DONE)) is None
