"""``cbtui new``: writes a small node as a starting point for a program of one's own."""

import argparse
import shlex
from pathlib import Path

from cbtui.text.output import complain, say


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("file", metavar="FILE.py", help="a new file")


def new(options: argparse.Namespace) -> int:
    """Write the file; returns the exit code: 0 on success, 1 if it could not be written."""
    from lessons.catalogue import ROOT
    from sim.files.atomic import write_atomically

    path = Path(options.file)
    if path.suffix != ".py":
        complain(f"{path} is not the name of a program: give one that ends in .py")
        return 1
    try:
        write_atomically(path, (ROOT / "own" / "node.py").read_bytes(), replace=False)
    except FileExistsError:
        complain(f"{path} is there already: nothing was written")
        return 1
    except OSError as error:
        complain(f"{path} cannot be written: {error.strerror}")
        return 1
    say(f"{path} is yours now: a timer, a subscription and a service.\n")
    say(f"See it run: {shlex.join(['cbtui', 'open', str(path)])}\n")
    return 0
