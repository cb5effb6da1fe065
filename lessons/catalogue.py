"""All lessons in teaching order, and the way to one of them by its id."""

from functools import cache
from pathlib import Path

from lessons.lesson import DESCRIPTION_FILE, Lesson, read_lesson

ROOT = Path(__file__).parent


class UnknownLesson(LookupError):  # noqa: N818 - the sentence it carries is what a reader sees
    """No lesson has the id that was asked for; the text is one sentence naming the nearest."""


@cache
def lessons() -> tuple[Lesson, ...]:
    """Return every lesson in teaching order. Read once; raises BadLesson when a folder is at fault."""
    found = (read_lesson(path.parent) for path in ROOT.glob(f"unit*/*/{DESCRIPTION_FILE}"))
    return tuple(sorted(found, key=lambda lesson: lesson.number))


def find(lesson_id: str) -> Lesson:
    """Return the lesson with this id. Raises UnknownLesson, which names the nearest one."""
    for lesson in lessons():
        if lesson.id == lesson_id:
            return lesson
    raise UnknownLesson(
        f"No lesson is called {lesson_id!r}; the nearest is {_nearest(lesson_id)!r}, "
        "and 'cbtui list' shows all."
    )


def _nearest(lesson_id: str) -> str:
    from difflib import get_close_matches  # needed for a wrong id only

    ids = [lesson.id for lesson in lessons()]
    return get_close_matches(lesson_id.lower(), ids, n=1, cutoff=0.0)[0]
