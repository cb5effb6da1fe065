"""``cbtui reset``: forgets the learner's progress in a lesson or a puzzle."""

import argparse

from cbtui.commands.options import more_lessons
from cbtui.commands.options.targets import lesson_of, puzzle_of
from cbtui.text.output import complain, say


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("lesson", metavar="LESSON|PUZZLE", help="a lesson's or puzzle's id, see cbtui list")
    more_lessons.add_option(parser)


def reset(options: argparse.Namespace) -> int:
    """Forget the progress in a lesson or puzzle; returns the exit code: 0, or 1 if that could not be saved.

    The learner's files stay as they are.
    """
    subject = puzzle_of(options.lesson) or lesson_of(options.lesson)
    from lessons.progress import Progress

    progress = Progress()
    was = progress.reset(subject.id)
    troubles = progress.troubles()
    for trouble in troubles:
        complain(trouble)
    if troubles:
        return 1
    say(f"{subject.id} starts afresh.\n" if was else f"{subject.id} had not been started.\n")
    return 0
