"""What the menu says of a lesson that is not done."""

import pytest

from cbtui.learning.stage import Stage, stage_note
from lessons.catalogue import find
from lessons.progress import LessonProgress


@pytest.mark.parametrize(
    ("lesson", "missing"),
    [
        ("cancel-never-served", "run it for 16 s or to its end, call /fetch, or have it explained"),
        ("qos-never-matches", "run it for 20 s or to its end, or have it explained"),
    ],
)
def test_what_makes_a_lesson_watched_is_told_where_it_is_missing(lesson: str, missing: str) -> None:
    note = stage_note(find(lesson), LessonProgress(lesson=lesson), Stage.PREDICTED)
    assert note.text == f"◐ predicted, not watched yet: {missing}"
