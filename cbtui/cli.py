"""The ``cbtui`` command: takes the command line apart, and hands it to the command that it names.

Whatever a command needs is imported when it runs: ``cbtui --help`` must answer at once.
"""

import argparse
import sys
from collections.abc import Callable, Sequence
from typing import NoReturn

from cbtui.commands import compare, console, export, info, listing, run
from cbtui.commands.ros2 import ros2


class _Parser(argparse.ArgumentParser):
    """A parser whose complaints are one line."""

    def error(self, message: str) -> NoReturn:
        """Say what was wrong and where to read more, and exit with 2."""
        self.exit(2, f"{self.prog}: {message} (see {self.prog} --help)\n")


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code: 0 well, 1 the run failed, 2 the command was wrong."""
    words = list(sys.argv[1:] if argv is None else argv)
    if words[:1] == ["ros2"]:
        return ros2(words[1:])
    split = words.index("--") if "--" in words else len(words)
    options = _parser().parse_args(words[:split])
    options.arguments = words[split + 1 :]
    action: Callable[[argparse.Namespace], int] = options.action
    return action(options)


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(
        prog="cbtui",
        description="A terminal teaching console for ROS 2 callback groups and executors.",
        epilog="Without a command the console opens on its menu of lessons.",
    )
    parser.add_argument("--version", action="version", version=f"cbtui {_version()}")
    console.add_options(parser)
    parser.set_defaults(action=console.open_console, target=None, clock="real")
    commands = parser.add_subparsers(title="commands", metavar="COMMAND")

    listing_parser = commands.add_parser("list", help="list the lessons")
    listing_parser.set_defaults(action=listing.list_lessons)

    opening = commands.add_parser(
        "open",
        help="open a lesson, or a file of your own, in the console",
        usage="%(prog)s [options] LESSON|FILE.py [-- ARGUMENTS of the file]",
    )
    console.add_open_options(opening)
    opening.set_defaults(action=console.open_console)

    running = commands.add_parser(
        "run",
        help="run a lesson, or files of your own, without the console",
        usage="%(prog)s [options] LESSON|FILE.py … [-- ARGUMENTS of the files]",
        description="Run a lesson, or node and launch files, headless: the log goes to stderr, a summary to "
        "stdout. Several files run at once, each as a process of its own would.",
    )
    run.add_options(running)
    running.set_defaults(action=run.run)

    replaying = commands.add_parser("replay", help="show a recording in the console")
    console.add_replay_options(replaying)
    replaying.set_defaults(action=console.replay)

    informing = commands.add_parser("info", help="tell what is in a recording")
    info.add_options(informing)
    informing.set_defaults(action=info.info)

    comparing = commands.add_parser(
        "compare",
        help="put two runs side by side",
        description="Put the same window of two runs side by side. Lessons and files are run for that, "
        "headless on virtual time.",
    )
    compare.add_options(comparing)
    comparing.set_defaults(action=compare.compare)

    exporting = commands.add_parser(
        "export",
        help="take a recording to trace viewers, spreadsheets and paper",
        usage="%(prog)s FILE.mcap --FORMAT OUT …",
    )
    export.add_options(exporting)
    exporting.set_defaults(action=export.export_command)

    commands.add_parser("ros2", help="carry out a ros2 line in the run that is going on", add_help=False)
    return parser


def _version() -> str:
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version("cbtui")
    except PackageNotFoundError:
        return "(not installed)"
