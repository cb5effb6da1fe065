"""``cbtui list``: the lessons."""

import argparse
import sys


def list_lessons(_options: argparse.Namespace) -> int:
    """Print the lessons."""
    from lessons.catalogue import lessons

    known = lessons()
    width = max(len(lesson.id) for lesson in known)
    for lesson in known:
        sys.stdout.write(f"{lesson.number}  {lesson.id:{width}}  {lesson.title}: {lesson.executor}\n")
    return 0
