"""``cbtui probe`` and ``cbtui attach``: real ROS 2 programs that others start, watched in the console."""

import argparse
import os
from pathlib import Path
from typing import TYPE_CHECKING

from cbtui.commands.console import console_look, run_console
from cbtui.commands.options.appearance import add_options
from cbtui.commands.options.targets import refuse
from cbtui.commands.options.values import duration, port, process_or_address
from cbtui.text.output import complain, say

if TYPE_CHECKING:
    from sim.real.wire import Hello


def add_probe_options(parser: argparse.ArgumentParser) -> None:
    """Give ``cbtui probe`` its arguments."""
    parser.add_argument(
        "--keep",
        metavar="SECONDS",
        type=duration,
        help="keep the last seconds in memory, and record them when a callback starves, a deadlock closes or "
        "a process dies",
    )
    parser.add_argument(
        "--tcp",
        metavar="PORT",
        type=port,
        help="let consoles of other machines in, too: on this port of the loopback interface, for ssh -L",
    )


def add_attach_options(parser: argparse.ArgumentParser) -> None:
    """Give ``cbtui attach`` its arguments."""
    parser.add_argument(
        "processes",
        metavar="PID|HOST:PORT",
        nargs="*",
        type=process_or_address,
        help="processes to watch: by their numbers (all that there are, and those that come), or where "
        "probe --tcp has them listen",
    )
    parser.add_argument("--token", help="what probe --tcp has printed (that of CBTUI_PROBE_TOKEN)")
    parser.add_argument("--list", action="store_true", help="only list what can be watched")
    add_options(parser)


def probe(options: argparse.Namespace) -> int:
    """Become the command after ``--``, or run it and keep its last seconds; returns its exit code."""
    command = options.arguments
    if not command:
        refuse("probe needs a command: cbtui probe -- python3 node.py, or cbtui probe -- ros2 launch …")
    import secrets
    import shutil

    program = shutil.which(command[0])
    if program is None:
        if Path(command[0]).is_file():
            refuse(f"{command[0]} is not executable; for a Python file give python3 {command[0]}")
        refuse(f"there is no program {command[0]}")
    from sim.real.programs import watched_environment

    folder, port, token = probes_folder(), options.tcp, secrets.token_urlsafe(16)
    if port is not None:
        complain(
            f"watch this through ssh -L {port}:localhost:{port} with: "
            f"cbtui attach localhost:{port} --token {token}"
        )
    complain("watch this with: cbtui attach")
    if options.keep is None:
        os.execve(program, command, watched_environment(program, folder, port, token))
    import tempfile

    from cbtui.runs.headless.keeping import run_and_keep
    from cbtui.runs.setup.shown_program import watched_setup
    from sim.engine.setup import RealRos

    with tempfile.TemporaryDirectory(prefix="command-", dir=folder) as own:
        setup = watched_setup(Path(command[-1]).stem, RealRos(watched=own))
        environment = watched_environment(program, Path(own), port, token)
        return run_and_keep(command, environment, setup, options.keep)


def attach(options: argparse.Namespace) -> int:
    """List the programs that can be watched, or open the console on them; returns the exit code."""
    from cbtui.runs.setup.shown_program import of_processes
    from sim.engine.setup import RealRos
    from sim.real.probe_link import processes_in, say_token
    from sim.real.watched import label_of

    if options.token is not None:
        say_token(options.token)
    addresses = tuple(each for each in options.processes if not isinstance(each, int))
    numbers = tuple(each for each in options.processes if isinstance(each, int))
    folder = probes_folder()
    found = [_process_at(each) for each in addresses]
    if numbers or not addresses:
        there = processes_in(folder)
        unknown = [each for each in numbers if each not in {hello.process for hello in there}]
        if unknown:
            why = "it was not started with cbtui probe, or has ended"
            refuse(f"process {unknown[0]} cannot be watched: {why}; cbtui attach --list tells which can")
        found += [hello for hello in there if not numbers or hello.process in numbers]
    if not found:
        refuse("no process can be watched: start one with cbtui probe -- COMMAND")
    if options.list:
        for hello in found:
            say(f"{label_of(hello)}  Python {hello.python}  {' '.join(hello.command)}\n")
        return 0
    watched = str(folder) if numbers or not addresses else ""
    real = RealRos(watched=watched, processes=numbers, addresses=addresses)
    return run_console(console_look(options, "cbtui attach --list"), start_program=of_processes(real, found))


def _process_at(address: tuple[str, int]) -> "Hello":
    """Return the process whose probe listens there; exits with code 2 and one line if there is none."""
    from sim.real.probe_link import has_token, process_at

    where = f"{address[0]}:{address[1]}"
    try:
        hello = process_at(address)
    except OSError as error:
        refuse(
            f"no probe listens at {where} ({error.strerror}); "
            "start one with cbtui probe --tcp PORT -- COMMAND"
        )
    if hello is None:
        wanted = "has another token" if has_token() else "wants a token"
        refuse(f"the probe at {where} {wanted}: give the one that cbtui probe --tcp printed by --token")
    return hello


def probes_folder() -> Path:
    """Return the folder in which probes listen; exits with code 2 and one line if it cannot be used."""
    from cbtui.engines.control_socket import UnusableFolderError, runtime_folder

    try:
        folder = runtime_folder() / "probes"
        folder.mkdir(mode=0o700, exist_ok=True)
    except (UnusableFolderError, OSError) as error:
        refuse(f"{error}; set XDG_RUNTIME_DIR to a folder of your own")
    return folder
