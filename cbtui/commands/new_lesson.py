"""``cbtui new-lesson``: a small lesson that is right as it is, to make another one of."""

import argparse
from pathlib import Path

from cbtui.text.output import complain, say


def add_options(parser: argparse.ArgumentParser) -> None:
    """Give the command its arguments."""
    parser.add_argument("folder", metavar="DIR", help="a new folder; its name is the lesson's id")


def new_lesson(options: argparse.Namespace) -> int:
    """Make a lesson; returns the exit code: 0 it is there, 1 it could not be made."""
    from cbtui.learning.lesson_scaffold import CannotScaffoldError, make_lesson

    folder = Path(options.folder)
    try:
        files = make_lesson(folder)
    except CannotScaffoldError as error:
        complain(str(error))
        return 1
    say("".join(f"{folder / file.name}\n" for file in files))
    say(
        f"Prove it: cbtui lint-lesson {folder}\n"
        f"See it: cbtui --lessons {folder} open {folder.absolute().name}\n"
    )
    return 0
