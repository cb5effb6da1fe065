"""Programs of timed waits, how long each has to last by plain Python's rules, and a process that runs them.

``python -m tests.clock.timed_waits`` lives on a virtual clock: for each program, a line of JSON, it answers
with the nanoseconds that every step took, or with what it raised.
"""

import json
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from random import Random
from typing import Any, NamedTuple

from sim.clock import VirtualClock
from sim.clock.asyncio_loops import ProgramLoops
from sim.clock.stdlib import live_on
from sim.probes.probe import SilentProbe
from sim.ros.middleware.host import Host, install
from tests.clock.waits import BEHIND, WAITS, WAITS_OUT

LENGTHS = (1e-12, 1e-9, 0.005, 0.01, 0.03, 0.05, 0.067, 0.1, 0.3, 1 / 3, 0.7, 1.07)
_RECESS = 1_000
"""Nanoseconds that such a wait may take beyond its deadline."""
_TIMEOUT = 60.0


class Step(NamedTuple):
    """One kind of wait, of some seconds, so many times; ``given``: seconds after which each is ended."""

    wait: str
    seconds: float
    times: int
    given: float | None

    @property
    def expected(self) -> float:
        """Nanoseconds that it takes by plain Python's rules."""
        ended_early = self.given is not None and self.wait not in WAITS_OUT
        return self.times * 1e9 * (min(self.seconds, self.given or 0) if ended_early else self.seconds)

    @property
    def slack(self) -> int:
        """Nanoseconds that it may take more or less: a few for every wait's rounding, and for floats'."""
        return self.times * (4 + (_RECESS if self.wait.endswith(BEHIND) else 0))


def random_program(seed: int) -> list[Step]:
    """Some steps, of any kind and length."""
    random = Random(seed)
    return [_random_step(random) for _ in range(random.randint(1, 6))]


def _random_step(random: Random) -> Step:
    seconds = random.choice((*LENGTHS, random.uniform(0, 3)))
    wait = random.choice(list(WAITS))
    times = 1 if wait.endswith(BEHIND) else random.choice((1, 3, 20))
    return Step(wait, seconds, times, random.choice((None, seconds / 3)) if seconds > 1e-6 else None)


def wrong_of(program: list[Step], took: list[int] | str) -> str | None:
    """What is wrong with how long the steps of a program took; None: nothing."""
    if isinstance(took, str):
        return took
    for step, each in zip(program, took, strict=True):
        if abs(each - step.expected) > step.slack:
            return f"{step} took {each} ns, not {step.expected:.3f}"
    return None


class Runner:
    """A process in which programs run on virtual time, one after another."""

    def __init__(self) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-m", __name__],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            cwd=Path(__file__).parents[2],
        )

    def run(self, program: list[Step]) -> list[int] | str:
        """The nanoseconds of each step; a sentence if the program did not come to its end."""
        process = self._process
        assert process.stdin is not None
        assert process.stdout is not None
        limit = threading.Timer(_TIMEOUT, process.kill)
        limit.start()
        process.stdin.write(json.dumps(program) + "\n")
        process.stdin.flush()
        answer = process.stdout.readline()
        limit.cancel()
        took: list[int] | str = json.loads(answer) if answer else f"no end within {_TIMEOUT:g} s"
        return took

    def close(self) -> None:
        """End the process."""
        self._process.kill()
        self._process.communicate()


def _run_step(wait: str, seconds: float, times: int, given: float | None) -> int:
    began = time.monotonic_ns()
    for _ in range(times):
        ends: list[threading.Thread] = []

        def later(action: Callable[[], object], ends: list[threading.Thread] = ends) -> None:
            if given is not None:
                ends.append(threading.Timer(given, action))
                ends[0].start()

        WAITS[wait](seconds, later)
        for each in ends:
            each.join()
    return time.monotonic_ns() - began


def _live() -> None:
    clock = VirtualClock()
    install(Host(clock, SilentProbe(clock)))
    live_on(clock)
    ProgramLoops(clock).install()
    for line in sys.stdin:
        try:
            answer: Any = [_run_step(*step) for step in json.loads(line)]
        except Exception as error:  # noqa: BLE001 -- told to whoever looks for such
            answer = repr(error)
        sys.stdout.write(json.dumps(answer) + "\n")
        sys.stdout.flush()


if __name__ == "__main__":
    _live()
