"""``cbtui compare``: two runs side by side; each is a recording, a lesson or a file."""

import argparse
from pathlib import Path

from cbtui.commands import values
from cbtui.commands.run import DEFAULT_SECONDS
from cbtui.commands.targets import file_of, is_file_name, lesson_of


def add_options(parser: argparse.ArgumentParser) -> None:
    """Give the command its arguments."""
    for name in ("A", "B"):
        parser.add_argument(name, help="a recording (.mcap), a lesson's id, or a node file")
    parser.add_argument(
        "--from",
        dest="start",
        metavar="SECONDS",
        type=values.moment,
        default=0.0,
        help="where to begin (%(default)g)",
    )
    parser.add_argument(
        "--to",
        dest="end",
        metavar="SECONDS",
        type=values.duration,
        help=f"where to end (where the shorter recording does; {DEFAULT_SECONDS:g} where there is none)",
    )
    parser.add_argument(
        "--call",
        dest="calls",
        metavar="SECONDS",
        type=values.moment,
        action="append",
        default=[],
        help="call the SetBool service of what is run at that time; may be given again",
    )


def compare(options: argparse.Namespace) -> int:
    """Put two runs side by side; returns the exit code."""
    from cbtui.contenders import Contender, compare_runs
    from cbtui.lesson_setup import setup_for, setup_for_files

    def contender(name: str) -> Contender:
        if name.endswith(".mcap"):
            return Contender(name, Path(name))
        if is_file_name(name):
            return Contender(name, setup_for_files([file_of(name)]))
        return Contender(name, setup_for(lesson_of(name)))

    return compare_runs(
        contender(options.A),
        contender(options.B),
        start=options.start,
        end=options.end,
        calls=options.calls,
    )
