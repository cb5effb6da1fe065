"""``cbtui list``: the lessons by unit, their puzzles, and how far the learner has come in each."""

import argparse
from itertools import groupby

from cbtui.text.output import say


def list_lessons(_options: argparse.Namespace) -> int:
    """Print the lessons."""
    from cbtui.learning.stage import puzzle_text, stage_of, stage_text
    from lessons.catalogue import lessons
    from lessons.progress import Progress
    from lessons.puzzles import puzzles_of

    known, progress = lessons(), Progress()
    width = max(len(lesson.id) for lesson in known)
    for unit, members in groupby(known, key=lambda lesson: lesson.unit):
        say(f"{unit}\n")
        for lesson in members:
            came = progress.of(lesson.id)
            stage = stage_text(lesson, came, stage_of(lesson, came, opened=False))
            exercise = ", with an exercise" if lesson.exercise is not None else ""
            text = f"{lesson.number:4}  {lesson.id:{width}}  {lesson.title}: {lesson.executor}{exercise}"
            say(f"{text}  {stage}\n" if stage else f"{text}\n")
            for puzzle in puzzles_of(lesson.id):
                so_far = puzzle_text(progress.of(puzzle.id))
                text = f"      {puzzle.id:{width}}  puzzle: {puzzle.title}"
                say(f"{text}  {so_far}\n" if so_far else f"{text}\n")
    return 0
