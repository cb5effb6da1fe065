"""``cbtui reset``: forgets how far the learner has come in a lesson."""

import argparse

from cbtui.commands.options import more_lessons
from cbtui.commands.options.targets import lesson_of
from cbtui.text.output import complain, say


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("lesson", metavar="LESSON", help="a lesson's id, see cbtui list")
    more_lessons.add_option(parser)


def reset(options: argparse.Namespace) -> int:
    """Forget the progress in a lesson; returns the exit code: 0 on success, 1 if that could not be saved.

    The learner's files stay as they are.
    """
    lesson = lesson_of(options.lesson)
    from lessons.progress import Progress

    progress = Progress()
    was = progress.reset(lesson.id)
    troubles = progress.troubles()
    for trouble in troubles:
        complain(trouble)
    if troubles:
        return 1
    say(f"{lesson.id} begins anew.\n" if was else f"{lesson.id} had not been begun.\n")
    return 0
