"""Looks for a program of timed waits at whose end virtual time is not where plain Python's would be.

``python -m tests.soak.waits --minutes 3 --seed 1`` runs programs at random on virtual time, those of the
seeds from 1 on. A seed that shows a fault shows it again. ``--record`` keeps what came of it.
"""

import argparse
import sys
import time
from itertools import count

from tests.clock.timed_waits import Runner, random_program, wrong_of
from tests.soak.results import FILE, record, today


def main() -> int:
    """Run the programs; returns the exit code: 0 all well, 1 one of them ended at another time."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=3.0, help="how long (%(default)s)")
    parser.add_argument("--seed", type=int, default=1, help="the first seed (%(default)s)")
    parser.add_argument("--record", action="store_true", help=f"put what came of it into {FILE.name}")
    options = parser.parse_args()
    began = time.monotonic()
    programs, waits, wrong = search(options.seed, began + options.minutes * 60)
    for seed, what in wrong.items():
        sys.stdout.write(f"seed {seed}: {what}\n")
    figures = {
        "programs": programs,
        "waits": waits,
        "seconds": round(time.monotonic() - began),
        "faults": len(wrong),
    }
    sys.stdout.write(f"from seed {options.seed}: {figures}\n")
    if options.record:
        record("waits", "programs", {"date": today(), "seed": options.seed, **figures})
    return 1 if wrong else 0


def search(first: int, until: float) -> tuple[int, int, dict[int, str]]:
    """Run programs from a seed on, one at least; how many, their waits, and what was wrong by seed."""
    waits, wrong = 0, {}
    runner = Runner()
    for seed in count(first):
        program = random_program(seed)
        waits += sum(step.times for step in program)
        what = wrong_of(program, runner.run(program))
        if what is not None:
            wrong[seed] = what
            runner.close()
            runner = Runner()
        if time.monotonic() >= until:
            break
    runner.close()
    return seed - first + 1, waits, wrong


if __name__ == "__main__":
    sys.exit(main())
