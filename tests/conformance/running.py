"""Runs the programs of systems on the model, or on the ROS 2 of an interpreter, and reads what they said."""

import json
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Iterator
from itertools import repeat
from pathlib import Path
from typing import NamedTuple

from sim.real.programs import claimed_domain, unbootstrapped
from tests.conformance import copies
from tests.conformance.steered import Choice, Steering


class Said(NamedTuple):
    """What a program said, and when, in seconds since it began."""

    words: tuple[str, ...]
    times: tuple[float, ...]
    moments: tuple[float, ...] = ()
    """On the model: when anything fell due."""
    late: float = 0.0
    """On real ROS 2: how late the machine was at most to wake a thread of the program."""
    choices: tuple[Choice, ...] = ()
    """On the model: the choices of what goes on next."""


def run_all(
    programs: Iterable[str],
    python: str | None,
    at_once: int,
    model_of: str = "",
    steering: Iterable[Steering | None] = repeat(None),
) -> Iterator[Said | None]:
    """Run programs on the ROS 2 of an interpreter, or on the model (None); None for one that said nothing.

    ``model_of`` is the distro whose named behaviours the model has; ``steering`` has, for each program, what
    the model's threads choose; None: first come, first served, and no choices are told. The next of either is
    asked for when fewer than ``at_once`` programs run.
    """
    domain, claim = claimed_domain()
    alone = {
        "ROS_DOMAIN_ID": str(domain),
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "OFF",
        "FASTDDS_BUILTIN_TRANSPORTS": "UDPv4",
    }
    executable = python or sys.executable
    environment = {**unbootstrapped(executable), **alone}
    if python is None:
        environment["PYTHONPATH"] = str(Path(__file__).parents[2])
    else:
        environment.pop("PYTHONPATH")
    with claim, tempfile.TemporaryDirectory() as folder:
        process = subprocess.Popen(
            [executable, copies.__file__, *(["model", model_of] if python is None else [])],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,  # for what is raised on purpose
            text=True,
            env=environment,
        )
        with process as running:
            assert running.stdin is not None
            assert running.stdout is not None
            ended: set[str] = set()
            given = told = 0
            for source, steered in zip(programs, steering, strict=False):
                file = Path(folder, f"{given}.py")
                file.write_text(source)
                running.stdin.write(json.dumps([str(file), str(file.with_suffix(".out")), steered]) + "\n")
                running.stdin.flush()
                given += 1
                if given >= at_once:
                    ended.add(running.stdout.readline().rstrip())
                while (output := Path(folder, f"{told}.out")) and str(output) in ended:
                    yield _read(output)
                    told += 1
            running.stdin.close()
            running.stdout.read()
            for place in range(told, given):
                yield _read(Path(folder, f"{place}.out"))


def _read(path: Path) -> Said | None:
    said, _, measured = path.read_text().partition("moments\n") if path.exists() else ("", "", "")
    if not measured:
        return None
    told = [line.split(" ", 1) for line in said.splitlines() if line]
    *lines, late = measured.splitlines()
    choices = [line.split()[1:] for line in lines if line.startswith("choice")]
    return Said(
        tuple(what for _, what in told),
        tuple(float(at) for at, _ in told),
        tuple(float(line) for line in lines if not line.startswith("choice")),
        float(late.removeprefix("late ")),
        tuple(Choice(*map(int, choice)) for choice in choices),
    )
