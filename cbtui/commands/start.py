"""``cbtui start``: puts the file that an exercise begins with where the learner works."""

import argparse
from pathlib import Path
from textwrap import fill

from cbtui.commands.check import exercise_of
from cbtui.commands.options import more_lessons
from cbtui.text.output import complain, say


def add_options(parser: argparse.ArgumentParser) -> None:
    """Give the command its arguments."""
    parser.add_argument("lesson", metavar="LESSON", help="a lesson with an exercise")
    parser.add_argument("folder", metavar="DIR", nargs="?", default=".", help="where to put it (here)")
    more_lessons.add_option(parser)


def start(options: argparse.Namespace) -> int:
    """Put the starter of an exercise into a folder; returns the exit code: 0 it is there, 1 it is not."""
    lesson = exercise_of(options.lesson)
    from cbtui.learning.exercise_files import CannotPlaceError, Placed, place_starter

    folder = Path(options.folder)
    path = folder / lesson.file_name
    try:
        placed = place_starter(lesson, folder)
    except CannotPlaceError as error:
        complain(str(error))
        return 1
    if placed is Placed.CHANGED:
        complain(
            f"{path} is there already, and is not as it was put there: nothing was written; "
            "give another folder, or move it away to begin again"
        )
        return 1
    assert lesson.exercise is not None, "there is a starter"
    known = "is there already, unchanged" if placed is Placed.THERE_ALREADY else "is yours now"
    say(f"{path} {known}.\n{fill(lesson.exercise.asks.strip(), 79)}\n")
    if folder == Path():
        say(f"In the console: cbtui open {lesson.id} --exercise\n")
    where = "" if folder == Path() else f" {path}"
    say(f"Then: cbtui check {lesson.id}{where}\n")
    return 0
