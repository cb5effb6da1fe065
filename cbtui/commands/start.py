"""``cbtui start``: copies the starter file of an exercise into the learner's folder."""

import argparse
from pathlib import Path
from textwrap import fill

from cbtui.commands.check import exercise_of
from cbtui.commands.options import more_lessons
from cbtui.text.output import complain, say


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("lesson", metavar="LESSON", help="a lesson with an exercise")
    parser.add_argument("folder", metavar="DIR", nargs="?", default=".", help="where to put it (here)")
    more_lessons.add_option(parser)


def start(options: argparse.Namespace) -> int:
    """Put the starter of an exercise into a folder; returns the exit code: 0 if it is there, else 2."""
    lesson = exercise_of(options.lesson)
    from cbtui.learning.exercise_files import CannotPlaceError, StarterPlacement, place_starter

    folder = Path(options.folder)
    path = folder / lesson.file_name
    try:
        placed = place_starter(lesson, folder)
    except CannotPlaceError as error:
        complain(str(error))
        return 2
    if placed is StarterPlacement.CHANGED:
        complain(
            f"{path} is there already, and is not as it was put there: nothing was written; "
            "give another folder, or move it away to begin again"
        )
        return 2
    assert lesson.exercise is not None, "there is a starter"
    known = "is there already, unchanged" if placed is StarterPlacement.THERE_ALREADY else "is yours now"
    say(f"{path} {known}.\n{fill(lesson.exercise.asks.strip(), 79)}\n")
    if folder == Path():
        say(f"In the console: cbtui open {lesson.id} --exercise\n")
    where = "" if folder == Path() else f" {path}"
    say(f"Then: cbtui check {lesson.id}{where}\n")
    return 0
