"""``ros2 launch``: starts the programs of a launch file."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path

from sim.shell.parser import LineParser
from sim.shell.programs import known_launch_files, known_packages, package, wait_for
from sim.shell.session import CommandFailed, LineExit, ShellSession
from sim.shell.verbs.verb import ShellCommand, Verb

_NOT_HERE = ("debug", "print", "show_all_subprocesses_output", "launch_prefix", "launch_prefix_filter")
_ASSIGNED = ":="


def _add_arguments(parser: LineParser) -> None:
    parser.flag(
        "-n", "--noninteractive", help="Run the launch system non-interactively, with no terminal associated"
    )
    parser.flag("-d", "--debug", help="Put the launch system in debug mode")
    parser.add_argument(
        "-p",
        "--print",
        "--print-description",
        action="store_true",
        dest="print",
        help="Print the launch description to the console without launching it.",
    )
    parser.add_argument(
        "-s",
        "--show-args",
        "--show-arguments",
        action="store_true",
        dest="show_args",
        help="Show arguments that may be given to the launch file.",
    )
    parser.flag(
        "-a",
        "--show-all-subprocesses-output",
        help="Show all launched subprocesses' output by overriding their output configuration",
    )
    parser.add_argument("--launch-prefix", help="Prefix command, which should go before all executables")
    parser.add_argument(
        "--launch-prefix-filter",
        help="Regex pattern for filtering which executables the --launch-prefix is applied to",
    )
    parser.argument(
        "package_name",
        help="Name of the ROS package which contains the launch file, or the path of a launch file",
        completer=known_packages,
    )
    parser.argument(
        "launch_file_name", nargs="?", help="Name of the launch file", completer=known_launch_files
    )
    parser.argument(
        "launch_arguments",
        nargs="*",
        metavar="launch_arguments",
        help="Arguments to the launch file; '<name>:=<value>' (for duplicates, last one wins)",
    )


def _launch(session: ShellSession, arguments: Namespace) -> None:
    for name in _NOT_HERE:
        if getattr(arguments, name):
            raise NotImplementedError(f"ros2 launch --{name.replace('_', '-')} is not supported here")
    owner, file, given = _chosen(session, arguments)
    for each in given:
        _check(each)
    if arguments.show_args:
        session.say(session.starter.describe_launch(owner, file))
        return
    status = wait_for(session, lambda on_exit: session.starter.launch(owner, file, given, on_exit))
    if status != 0:
        raise LineExit(status)


def _chosen(session: ShellSession, arguments: Namespace) -> tuple[str | None, str, list[str]]:
    """Package (None: a path is given), launch file and the arguments for it."""
    first, second, others = arguments.package_name, arguments.launch_file_name, arguments.launch_arguments
    if second is None or _ASSIGNED in second or Path(first).is_file():
        if not Path(first).is_file():
            raise CommandFailed(
                f"'{first}' is not a launch file; one of a package needs the package's name before it"
            )
        return None, first, [*([] if second is None else [second]), *others]
    package(session, first).launch_file(second)
    return first, second, others


def _check(argument: str) -> None:
    name, assigned, _ = argument.partition(_ASSIGNED)
    if not assigned or not name:
        raise CommandFailed(f"malformed launch argument '{argument}', expected format '<name>:=<value>'")


LAUNCH = ShellCommand(
    "launch", "Run a launch file", itself=Verb("launch", "Run a launch file", _add_arguments, _launch)
)
