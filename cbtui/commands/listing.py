"""``cbtui list``: the lessons by unit, their puzzles, and the learner's progress in each."""

import argparse
from itertools import groupby
from typing import TYPE_CHECKING

from cbtui.text.output import complain, say

if TYPE_CHECKING:
    from cbtui.learning.stage import StageNote


def list_lessons(_options: argparse.Namespace) -> int:
    """Print the lessons, and what is wrong with those that are left out."""
    from cbtui.learning.stage import Stage, puzzle_note, stage_note, stage_of
    from lessons.catalogue import faults, lessons
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
            _say_row(stage_note(lesson, came, stage), f"{lesson.number:2}", about)
            for puzzle in puzzles_of(lesson.id):
                about = f"{puzzle.id:{width}}  puzzle: {puzzle.title}"
                _say_row(puzzle_note(progress.of(puzzle.id)), "", about)
    for fault in faults():
        complain(str(fault))
    return 0


def _say_row(note: "StageNote", number: str, about: str) -> None:
    """Print an entry with the sign of its note before it and the words after it."""
    say(f" {note.sign:1} {number:2}  {about}{f'; {note.words}' if note.words else ''}\n")
