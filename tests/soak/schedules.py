"""Looks for an order of threads in which the executors break a rule: random systems, a schedule for each.

``python -m tests.soak.schedules --schedules 10000 --seed 1`` tries the seeds from 1 on, in as many processes
as there are cores. A seed that shows a fault shows it again, alone. ``--record`` keeps what came of it.
"""

import argparse
import os
import sys
import time
from multiprocessing import get_context

from tests.ros.scheduling.schedules import Trouble, trouble_of
from tests.soak.results import FILE, record, today

_CHUNK = 25


def main() -> int:
    """Try the seeds; returns the exit code: 0 all well, 1 a schedule shows a fault."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--schedules", type=int, default=10_000, help="how many (%(default)s)")
    parser.add_argument("--seed", type=int, default=1, help="the first seed (%(default)s)")
    parser.add_argument("--processes", type=int, default=os.cpu_count(), help="at once (%(default)s)")
    parser.add_argument("--record", action="store_true", help=f"put what came of it into {FILE.name}")
    options = parser.parse_args()
    began = time.monotonic()
    seeds = range(options.seed, options.seed + options.schedules)
    found = _search(seeds, options.processes)
    for trouble in found:
        sys.stdout.write(f"{trouble}\n")
    seconds = time.monotonic() - began
    sys.stdout.write(
        f"{len(seeds)} schedules from seed {seeds.start}, {len(found)} with a fault, {seconds:.0f} s\n"
    )
    if options.record:
        figures = {"schedules": len(seeds), "seconds": round(seconds), "faults": len(found)}
        record("schedules", "executors", {"date": today(), "seed": seeds.start, **figures})
    return 1 if found else 0


def _search(seeds: range, processes: int) -> list[Trouble]:
    found = []
    with get_context("spawn").Pool(processes) as pool:
        for done, trouble in enumerate(pool.imap(trouble_of, seeds, _CHUNK), start=1):
            if trouble is not None:
                found.append(trouble)
            if sys.stderr.isatty() and done % _CHUNK == 0:
                sys.stderr.write(f"\r{done}/{len(seeds)}, {len(found)} with a fault ")
    return found


if __name__ == "__main__":
    sys.exit(main())
