"""Real executors beside the model's, by one program, in turns: how many times as much the real ones take."""

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from statistics import median

from sim.real.programs import claimed_domain, unbootstrapped
from tests.benchmarks import on_both

_ALONE = {"ROS_AUTOMATIC_DISCOVERY_RANGE": "OFF", "FASTDDS_BUILTIN_TRANSPORTS": "UDPv4"}


def ratios(python: str, rounds: int) -> Iterator[tuple[str, float]]:
    """For each row, what a callback takes on an interpreter's rclpy, as a multiple of what it takes here."""
    taken = [(_seconds(python), _seconds(sys.executable, "model")) for _ in range(rounds)]
    for name in taken[0][0]:
        yield name, median(real[name] / model[name] for real, model in taken)


def _seconds(python: str, *arguments: str) -> dict[str, float]:
    domain, claim = claimed_domain()
    environment = {**unbootstrapped(python), **_ALONE, "ROS_DOMAIN_ID": str(domain)}
    if arguments:
        environment["PYTHONPATH"] = str(Path(__file__).parents[2])
    with claim:
        told = subprocess.run(
            [python, on_both.__file__, *arguments],
            env=environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            check=True,
            text=True,
            timeout=300,
        ).stdout
    return {name: float(taken) for name, taken in map(str.split, told.splitlines())}
