"""``cbtui list``: the lessons by unit, their puzzles, and how far the learner has come in each."""

import argparse
from itertools import groupby

from cbtui.text.output import say


def list_lessons(_options: argparse.Namespace) -> int:
    """Print the lessons."""
    from cbtui.learning.stage import Stage, puzzle_text, stage_of, stage_text
    from lessons.catalogue import lessons
    from lessons.progress import Progress
    from lessons.puzzles import puzzles_of

    known, progress = lessons(), Progress()
    width = max(len(lesson.id) for lesson in known)
    for unit, members in groupby(known, key=lambda lesson: lesson.unit):
        of_unit = [(lesson, progress.of(lesson.id)) for lesson in members]
        stages = [stage_of(lesson, came, opened=False) for lesson, came in of_unit]
        say(f"{unit}: {stages.count(Stage.DONE)} of {len(stages)} done\n")
        for (lesson, came), stage in zip(of_unit, stages, strict=True):
            exercise = ", with an exercise" if lesson.exercise is not None else ""
            about = f"{lesson.id:{width}}  {lesson.title}: {lesson.executor}{exercise}"
            _say_row(stage_text(lesson, came, stage), f"{lesson.number:2}", about)
            for puzzle in puzzles_of(lesson.id):
                about = f"{puzzle.id:{width}}  puzzle: {puzzle.title}"
                _say_row(puzzle_text(progress.of(puzzle.id)), "", about)
    return 0


def _say_row(stage: str, number: str, about: str) -> None:
    """Print an entry, with the sign of its stage in front and what that means behind."""
    sign, _, words = stage.partition(" ")
    say(f" {sign:1} {number:2}  {about}{f'; {words}' if words else ''}\n")
