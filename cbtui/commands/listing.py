"""``cbtui list``: the lessons."""

import argparse

from cbtui.text.output import say


def list_lessons(_options: argparse.Namespace) -> int:
    """Print the lessons."""
    from lessons.catalogue import lessons

    known = lessons()
    width = max(len(lesson.id) for lesson in known)
    for lesson in known:
        exercise = ", with an exercise" if lesson.exercise is not None else ""
        say(f"{lesson.number:2}  {lesson.id:{width}}  {lesson.title}: {lesson.executor}{exercise}\n")
    return 0
