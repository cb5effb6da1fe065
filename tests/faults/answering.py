"""How long a person waits for a key while a fault goes on: ``python -m tests.faults.answering [FAULT…]``.

Each fault is provoked in a console in a terminal of its own, in which ``?`` opens and closes the help: a wait
lasts from the key until the window, or what was beneath it, is drawn. It is wall time, so whatever else the
machine does is in it; the load is recorded with it. Nothing may be left when the console is closed.
"""

import argparse
import os
import random
import sys
import time
from contextlib import chdir
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory

import pytest

from cbtui.engines.memory_limit import MEMORY_LIMIT
from tests.benchmarks.console import RUNS, opened
from tests.faults.catalogue import FAULTS, Fault
from tests.faults.support import ANSWERED, node_with, nothing_left
from tests.soak.results import Entry, record

FILE = Path(__file__).with_name("answers.toml")
PART = "answering"
_KEY = "?"
_SHOWN = (rb"\bSigns and keys\b", rb"\bGuide\b")
"""What is drawn when the help opens, and when it closes."""
_PAUSES = 0.05, 0.30
"""Seconds between what a key did and the next, so that keys fall anywhere between two frames."""
_MEMORY = "1"
"""GB that a node may use here."""


def main() -> int:
    """Measure what was asked for; returns the exit code: 0 all answered in time, 1 not all."""
    options = _parse()
    late = 0
    for name in options.faults or FAULTS:
        load = os.getloadavg()[0]
        taken = waits(FAULTS[name], options.presses)
        late += median(taken) > ANSWERED
        sys.stdout.write(f"{line_of(name, taken)}\n")
        sys.stdout.flush()
        if options.record:
            record(PART, name, entry_of(taken, load), FILE)
    return min(late, 1)


def waits(fault: Fault, presses: int) -> list[float]:
    """The seconds that each key took, in a console of its own in which the fault goes on."""
    chance = random.Random(presses)
    taken = []
    with (
        pytest.MonkeyPatch.context() as patch,
        nothing_left(),
        TemporaryDirectory() as folder,
        chdir(folder),
    ):
        patch.setenv(MEMORY_LIMIT, _MEMORY)
        # A full disk would leave the beginnings of what Python compiles, which no later console can read.
        patch.setenv("PYTHONDONTWRITEBYTECODE", "1")
        path = node_with(Path(folder), fault.code, again=fault.again)
        with opened("open", path.name, "--clock", fault.clock) as console:
            console.until(RUNS)
            with fault.strike(console):
                for number in range(presses):
                    console.watch(chance.uniform(*_PAUSES))
                    console.press(_KEY)
                    taken.append(console.until(_SHOWN[number % 2]))
    return taken


def line_of(name: str, taken: list[float]) -> str:
    """What came of a fault, on one line; one during which half of the keys took too long is marked."""
    half, last = median(taken), max(taken)
    over = "  over" if half > ANSWERED else ""
    return (
        f"{name:<40} half of {len(taken)} keys within {half * 1e3:>4.0f} ms, all {last * 1e3:>5.0f} ms{over}"
    )


def entry_of(taken: list[float], load: float) -> Entry:
    """What is recorded of a fault; ``load`` is how many processes wanted a core before."""
    return {
        "date": time.strftime("%Y-%m-%d", time.gmtime()),
        "keys": len(taken),
        "half_ms": round(median(taken) * 1e3),
        "all_ms": round(max(taken) * 1e3),
        "load": round(load, 1),
    }


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.faults.answering", description=__doc__)
    parser.add_argument("faults", nargs="*", metavar="FAULT", help="by name, as in catalogue.py (all)")
    parser.add_argument("--presses", type=int, default=12, help="how many keys each (%(default)s)")
    parser.add_argument("--record", action="store_true", help=f"put what came of it into {FILE.name}")
    options = parser.parse_args()
    if unknown := [name for name in options.faults if name not in FAULTS]:
        parser.error(f"there is no fault {unknown[0]!r}; there are {', '.join(FAULTS)}")
    return options


if __name__ == "__main__":
    sys.exit(main())
