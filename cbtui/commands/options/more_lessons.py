"""The option that adds lessons from other folders."""

import argparse
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from cbtui.commands.options.targets import folder_of, refuse

_VARIABLE = "CBTUI_LESSONS"
"""The variable that ``lessons.catalogue`` reads; child processes inherit it."""


def add_option(parser: argparse.ArgumentParser) -> None:
    """Add the option to a command; it may stand before or after the command."""
    parser.add_argument(
        "--lessons",
        metavar="DIR",
        action="append",
        default=argparse.SUPPRESS,
        help=f"a folder with more lessons; may be given again (else: {_VARIABLE})",
    )


@contextmanager
def lessons_added(options: argparse.Namespace) -> Iterator[None]:
    """Add the lessons of the given folders to the catalogue inside the block."""
    folders: list[str] = getattr(options, "lessons", [])
    for folder in folders:
        folder_of(folder)
        if os.pathsep in str(Path(folder).resolve()):
            refuse(f"{folder}: a folder with {os.pathsep!r} in its path cannot be looked up for lessons")
    before = os.environ.get(_VARIABLE)
    if folders:
        paths = [str(Path(folder).resolve()) for folder in folders]
        os.environ[_VARIABLE] = os.pathsep.join([*paths, *filter(None, [before])])
    try:
        yield
    finally:
        if before is None:
            os.environ.pop(_VARIABLE, None)
        else:
            os.environ[_VARIABLE] = before
