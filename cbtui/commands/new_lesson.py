"""``cbtui new-lesson``: creates a small, valid lesson as a starting point."""

import argparse
import shlex
from pathlib import Path

from cbtui.text.output import complain, say


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("folder", metavar="DIR", help="a new folder; its name is the lesson's id")


def new_lesson(options: argparse.Namespace) -> int:
    """Create a lesson; returns the exit code: 0 on success, 2 if it could not be created."""
    from cbtui.learning.lesson_scaffold import CannotScaffoldError, make_lesson

    folder = Path(options.folder)
    try:
        files = make_lesson(folder)
    except CannotScaffoldError as error:
        complain(str(error))
        return 2
    say("".join(f"{folder / file.name}\n" for file in files))
    where = shlex.quote(str(folder))
    say(
        f"Prove it: cbtui lint-lesson {where}\n"
        f"See it: cbtui --lessons {where} open {folder.absolute().name}\n"
    )
    return 0
