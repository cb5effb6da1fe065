"""The ``cbtui`` command: parses the command line and calls the command it names.

Whatever a command needs is imported when it runs: ``cbtui --help`` must answer at once. The commands
themselves are imported where something was typed after ``cbtui``: the menu needs none of them.
"""

import argparse
import sys
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import NoReturn

from cbtui.commands import console
from cbtui.commands.options import appearance, more_lessons, outputs
from cbtui.commands.options.command_parser import CommandParser
from cbtui.commands.options.targets import refuse
from cbtui.engines.memory_limit import BadMemoryLimitError, memory_limit
from cbtui.terminal import streams
from cbtui.text.output import CannotSayError, is_text, say

_BROKEN_PIPE = 141
"""Exit code when the reader of standard output closed the pipe: a shell's code for death by SIGPIPE."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code.

    0: success; 1: the run failed; 2: the command was wrong; 130: interrupted; 141: the reader of standard
    output closed the pipe.
    """
    streams.repair_streams()
    try:
        code = _run_command(list(sys.argv[1:] if argv is None else argv))
    except SystemExit:
        streams.flush_streams()
        raise
    except OSError as error:
        trouble = streams.flush_streams()
        if trouble is None and not isinstance(error, BrokenPipeError | CannotSayError):
            raise
        return _say_unwritable(trouble or error)
    trouble = streams.flush_streams()
    return code if trouble is None else _say_unwritable(trouble)


def _say_unwritable(trouble: OSError) -> int:
    """Report that standard output cannot be written, unless its reader closed it; returns the exit code."""
    if isinstance(trouble, BrokenPipeError):
        return _BROKEN_PIPE
    with suppress(OSError):
        sys.stderr.write(f"cbtui: its output cannot be written: {trouble.strerror}\n")
    streams.flush_streams()
    return 1


def _run_command(words: list[str]) -> int:
    if words[:1] == ["ros2"]:
        from cbtui.commands.ros2 import ros2

        return ros2(words[1:])
    split = words.index("--") if "--" in words else len(words)
    options = _parser(with_commands=bool(words)).parse_args(words[:split])
    options.arguments = words[split + 1 :]
    if not all(map(is_text, options.arguments)):
        refuse("what follows -- has to be text in UTF-8")
    appearance.check_theme(options)
    _check_folder()
    _check_memory_limit()
    action: Callable[[argparse.Namespace], int] = options.action
    with more_lessons.lessons_added(options), outputs.only_data_to_stdout(options):
        try:
            return action(options)
        except KeyboardInterrupt:
            return 130
        except ValueError as error:
            _refuse_bad_lesson(error)
            raise


def _check_folder() -> None:
    """Exit with code 2 and one line if the current folder no longer exists."""
    try:
        Path.cwd()
    except OSError as error:
        refuse(f"the current folder cannot be used: {error.strerror}; go to another one")


def _check_memory_limit() -> None:
    """Exit with code 2 and one line if the memory limit in the environment is not a number."""
    try:
        memory_limit()
    except BadMemoryLimitError as error:
        refuse(str(error))


def _refuse_bad_lesson(error: ValueError) -> None:
    """Exit with code 2 and one line if a lesson's files are at fault."""
    from lessons.lesson import BadLesson

    if isinstance(error, BadLesson):
        refuse(str(error))


def _parser(*, with_commands: bool = True) -> argparse.ArgumentParser:
    parser = CommandParser(
        prog="cbtui",
        description="A terminal teaching console for ROS 2 callback groups and executors. "
        "Without a command it opens on its menu of lessons.",
        epilog="cbtui COMMAND --help tells more of a command.",
    )
    parser.add_argument("--version", action=_VersionAction, nargs=0, help="show the version and exit")
    appearance.add_options(parser)
    appearance.set_defaults(parser)
    more_lessons.add_option(parser)
    parser.set_defaults(action=console.open_console, target=None)
    if with_commands:
        from cbtui.cli_commands import add_commands

        add_commands(parser, _parser)
    return parser


class _VersionAction(argparse.Action):
    """Prints the version and exits; the look-up is slow, so it is done only here."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> NoReturn:
        from cbtui.version import own_version

        say(f"cbtui {own_version()}\n")
        parser.exit()
