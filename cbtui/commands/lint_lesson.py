"""``cbtui lint-lesson``: verifies lessons and prints their faults."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from cbtui.commands.check import add_limit
from cbtui.commands.options.targets import folder_of, refuse
from cbtui.text.output import say

if TYPE_CHECKING:
    from collections.abc import Iterator


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument(
        "folder", metavar="DIR", help="a lesson's folder, or one in which there are lessons' folders"
    )
    add_limit(parser, 60)


def lint_lesson(options: argparse.Namespace) -> int:
    """Verify lessons; returns the exit code: 0 if all their claims are true, else 1."""
    from cbtui.learning.lesson_lint import faults_of

    count = 0
    for each in _lessons_in(folder_of(options.folder)):
        faults = 0
        for fault in faults_of(each, options.limit):
            say(f"{fault}\n")
            faults += 1
        if not faults:
            say(f"{each}: all is as it says\n")
        count += faults
    return 1 if count else 0


def _lessons_in(folder: Path) -> "Iterator[Path]":
    """Return the folder itself, or the folders in it that contain a lesson's description."""
    from lessons.lesson import DESCRIPTION_FILE

    try:
        inside = sorted(path.parent for path in folder.glob(f"*/{DESCRIPTION_FILE}"))
        if (folder / DESCRIPTION_FILE).is_file() or not inside:
            return iter([folder])
    except OSError as error:
        refuse(f"{folder} cannot be read: {error.strerror}")
    return iter(inside)
