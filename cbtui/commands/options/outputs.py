"""The files that a command writes: one that is there already is only replaced with ``--force``."""

import argparse
import os
import sys
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, redirect_stdout
from pathlib import Path
from stat import S_ISDIR, S_ISREG

from cbtui.commands.options.targets import refuse, same_file
from sim.files.untrusted import mode_of

STANDARD_OUTPUT = "/dev/stdout"
_STDOUT = 1


def file_or_stream(word: str) -> str:
    """Return the path that an option's word names; ``-`` is standard output."""
    return STANDARD_OUTPUT if word == "-" else word


@contextmanager
def only_data_to_stdout(options: argparse.Namespace) -> Iterator[None]:
    """While an option names standard output as its file, send all else that goes there to standard error."""
    if STANDARD_OUTPUT not in vars(options).values():
        yield
        return
    there = os.fstat(_STDOUT)
    if S_ISREG(there.st_mode) and there.st_size:
        refuse("standard output goes to a file with content, which would be lost; name a file, or add | cat")
    with redirect_stdout(sys.stderr):
        yield


def add_force(parser: argparse.ArgumentParser) -> None:
    """Add ``--force``."""
    parser.add_argument("--force", action="store_true", help="replace files that are there already")


def check_outputs(outputs: Mapping[str, str | Path | None], inputs: Iterable[Path], *, force: bool) -> None:
    """Exit with code 2 and one line unless each output, by its option, has a file of its own.

    It can be written, and may be there already only with ``force``; pipes and devices are always written to.
    """
    wanted = [(option, Path(name)) for option, name in outputs.items() if name is not None]
    if force and not wanted:
        refuse("--force replaces files that are there already; no file to write is named")
    taken = list(inputs)
    for option, path in wanted:
        for each in taken:
            if same_file(each, path):
                refuse(f"{option} would overwrite {each}; give it a file of its own")
        if not force and str(path) != STANDARD_OUTPUT and _is_file(path):
            refuse(f"there is a file {path} already; give another name, or --force to replace it")
        _check_writable(path)
        taken.append(path)


def _is_file(path: Path) -> bool:
    try:
        return S_ISREG(mode_of(path))
    except OSError:  # writing it says why
        return False


def _check_writable(path: Path) -> None:
    """Refuse a file that cannot be written before any program is run."""
    try:
        mode = mode_of(path)
        place = path if mode else path.parent
        if S_ISDIR(mode):
            refuse(f"{path} cannot be written: it is a folder")
        if not mode_of(place):
            refuse(f"{path} cannot be written: there is no folder {place}")
    except OSError as error:
        refuse(f"{path} cannot be written: {error.strerror}")
    if not os.access(place, os.W_OK):
        refuse(f"{path} cannot be written: you may not write there")
