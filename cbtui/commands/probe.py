"""``cbtui probe`` and ``cbtui attach``: real ROS 2 programs that others start, watched in the console."""

import argparse
import os
import shutil
from typing import TYPE_CHECKING, NoReturn

from cbtui.commands.options.appearance import add_options, appearance, console_of
from cbtui.commands.options.targets import need_terminal, refuse
from cbtui.text.output import complain, say

if TYPE_CHECKING:
    from pathlib import Path


def add_attach_options(parser: argparse.ArgumentParser) -> None:
    """Give ``cbtui attach`` its arguments."""
    parser.add_argument(
        "processes",
        metavar="PID",
        nargs="*",
        type=int,
        help="numbers of processes to watch (all that there are, and those that come)",
    )
    parser.add_argument("--list", action="store_true", help="only list what can be watched")
    add_options(parser)


def probe(options: argparse.Namespace) -> NoReturn:
    """Become the command behind ``--``, whose rclpy processes can be watched from then on."""
    command = options.arguments
    if not command:
        refuse("probe needs a command: cbtui probe -- python3 node.py, or cbtui probe -- ros2 launch …")
    program = shutil.which(command[0])
    if program is None:
        refuse(f"there is no program {command[0]}")
    from sim.real.programs import watched_environment

    folder = probes_folder()
    complain("watch this with: cbtui attach")
    os.execve(program, command, watched_environment(program, folder))


def attach(options: argparse.Namespace) -> int:
    """List what can be watched, or open the console on it; returns the exit code."""
    from cbtui.runs.setup.shown_program import of_processes
    from sim.real.probe_link import processes_in
    from sim.real.watched import label_of

    folder = probes_folder()
    found = processes_in(folder)
    unknown = [str(each) for each in options.processes if each not in {hello.process for hello in found}]
    if unknown:
        refuse(f"no process {unknown[0]} can be watched; cbtui attach --list tells which can")
    if not found:
        refuse("no process can be watched: start one with cbtui probe -- COMMAND")
    if options.list:
        for hello in found:
            say(f"{label_of(hello)}  Python {hello.python}  {' '.join(hello.command)}")
        return 0
    look = appearance(options)
    need_terminal("cbtui attach --list")
    chosen = [hello for hello in found if hello.process in (options.processes or [hello.process])]
    app = console_of(look, start_program=of_processes(folder, tuple(options.processes), chosen))
    app.run()
    return app.return_code or 0


def probes_folder() -> "Path":
    """The folder in which probes listen; one that cannot be used ends the program with one line and 2."""
    from cbtui.engines.control_socket import UnusableFolderError, runtime_folder

    try:
        folder = runtime_folder() / "probes"
        folder.mkdir(mode=0o700, exist_ok=True)
    except (UnusableFolderError, OSError) as error:
        refuse(f"{error}; set XDG_RUNTIME_DIR to a folder of your own")
    return folder
