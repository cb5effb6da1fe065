"""``ros2 run``: starts a program of a package."""

from __future__ import annotations

import argparse
import signal
from argparse import Namespace

from sim.shell.parser import LineParser
from sim.shell.programs import known_executables, known_packages, package, wait_for
from sim.shell.session import LineExit, ShellSession
from sim.shell.verbs.verb import ShellCommand, Verb

_SAYS = "[ros2run]:"


def _add_arguments(parser: LineParser) -> None:
    parser.add_argument(
        "--prefix",
        help="Prefix command, which should go before the executable. Command must be wrapped in quotes if it "
        "contains spaces (e.g. --prefix 'gdb -ex run --args').",
    )
    parser.argument("package_name", help="Name of the ROS package", completer=known_packages)
    parser.argument("executable_name", help="Name of the executable", completer=known_executables)
    parser.argument("argv", nargs=argparse.REMAINDER, help="Pass arbitrary arguments to the executable")


def _run(session: ShellSession, arguments: Namespace) -> None:
    if arguments.prefix is not None:
        raise NotImplementedError(
            "ros2 run --prefix is not supported here: programs run inside the engine, without a command "
            "before them"
        )
    chosen = package(session, arguments.package_name)
    executable = chosen.executable(arguments.executable_name)
    status = wait_for(
        session,
        lambda on_exit: session.starter.start_executable(
            chosen.name, executable.name, arguments.argv, on_exit
        ),
    )
    if status < 0:
        session.say(f"{_SAYS} {signal.strsignal(-status)}")
    elif status > 0:
        session.say(f"{_SAYS} Process exited with failure {status}")
    if status != 0:
        raise LineExit(status)


RUN = ShellCommand(
    "run",
    "Run a package specific executable",
    itself=Verb("run", "Run a package specific executable", _add_arguments, _run),
)
