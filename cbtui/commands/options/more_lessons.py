"""The option that brings in lessons from other folders."""

import argparse
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from cbtui.commands.options.targets import folder_of, refuse

_VARIABLE = "CBTUI_LESSONS"
"""What ``lessons.catalogue`` looks at; so the programs that this one starts look there too."""


def add_option(parser: argparse.ArgumentParser) -> None:
    """Give a command the option; it may stand before the command as well as after it."""
    parser.add_argument(
        "--lessons",
        metavar="DIR",
        action="append",
        default=argparse.SUPPRESS,
        help=f"a folder with more lessons; may be given again (else: {_VARIABLE})",
    )


@contextmanager
def brought_in(options: argparse.Namespace) -> Iterator[None]:
    """Have the lessons of the folders that were given in the catalogue, meanwhile."""
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
