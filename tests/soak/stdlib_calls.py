"""Looks for calls of the standard library that take another time, or have other results, than the table says.

``python -m tests.soak.stdlib_calls --minutes 3 --seed 1`` composes programs of rows of
``tests/clock/stdlib_table.py`` on several threads, in an order of threads at random, and runs each twice on
virtual time. Every row must take its time; programs of repeatable rows must have the same events byte for
byte, and the others must say that they are not repeatable. ``--record`` keeps what came of it.
"""

import argparse
import json
import sys
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from random import Random

import msgspec

from sim.engine.setup import ProgramSetup, RobotUse, RunSetup
from sim.trace.events import Notice, Printed
from tests.clock.stdlib_table import PRELUDE, ROWS, Does, Row
from tests.soak.interruption import until_interrupted
from tests.soak.results import FILE, record, today
from tests.support.engine_runs import SECOND, Run, run_to_end

_SLACK = 2.0
"""Seconds that outside work may take longer, with two engines on a loaded machine."""
_EXACT = {Does.VIRTUAL, Does.SEEDED}
_ON_ANY_THREAD = [row for row in ROWS if row.does in _EXACT and "signal" not in row.call]
_SELDOM_HOLD = {"multiprocessing.pool.ThreadPool"}
"""Calls that need not wait for something outside: what comes by a pipe may be there already."""
_MARK = "came "
_PROGRAM = """
import json

def go(place, rows):
    for number, (body, refused) in enumerate(rows):
        began, error = time.monotonic_ns(), ""
        try:
            exec(body, dict(globals()))
        except Exception as raised:
            error = repr(raised)
        print("{mark}" + json.dumps([place, number, time.monotonic_ns() - began, error]))

parts = json.loads({parts!r})
threads = [thread(go, place, part) for place, part in enumerate(parts) if place]
go(0, parts[0])
for each in threads:
    each.join()
"""


@dataclass(frozen=True)
class Composition:
    """Rows for the main thread, and for each other thread; ``order`` seeds the order of the threads."""

    parts: tuple[tuple[Row, ...], ...]
    order: int

    @property
    def repeats(self) -> bool:
        """Whether every run of it is the same."""
        return all(row.does in _EXACT | {Does.REFUSED} for part in self.parts for row in part)

    def source(self) -> str:
        """The program."""
        parts = json.dumps([[(row.body, row.does is Does.REFUSED) for row in part] for part in self.parts])
        return PRELUDE + _PROGRAM.format(mark=_MARK, parts=parts)


def compose(seed: int) -> Composition:
    """The program that a seed stands for; every other one of rows that are repeatable."""
    random = Random(seed)
    for_main = [row for row in ROWS if row.does in _EXACT or seed % 2]
    main = tuple(random.choices(for_main, k=8))
    others = (
        tuple(random.choices(_ON_ANY_THREAD, k=random.randint(1, 8))) for _ in range(random.randint(0, 3))
    )
    return Composition((main, *others), random.choice([0, random.randint(1, 1_000_000)]))


def troubles_of(seed: int) -> list[str]:
    """Run what a seed stands for twice; what was wrong with that, in sentences."""
    composition = compose(seed)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "program.py"
        path.write_text(composition.source(), encoding="utf-8")
        runs = [run_to_end(_setup(path, composition)) for _ in range(2)]
    troubles = [trouble for run in runs for trouble in _troubles_of_run(composition, run)]
    if composition.repeats and msgspec.json.encode(runs[0].events) != msgspec.json.encode(runs[1].events):
        troubles.append("its two runs are not the same")
    return [f"seed {seed}: {trouble}" for trouble in troubles]


def _setup(path: Path, composition: Composition) -> RunSetup:
    return RunSetup(
        title="program.py",
        programs=(ProgramSetup(str(path)),),
        clock="virtual",
        speed=None,
        robot=RobotUse.NEVER,
        seed=composition.order,
        until=600 * SECOND,
    )


def _troubles_of_run(composition: Composition, run: Run) -> Iterator[str]:
    if run.loss is not None or run.ending.failed:
        yield run.loss or run.ending.reason
        return
    text = "".join(f"{event.text}\n" for event in run.events if isinstance(event, Printed))
    came = [json.loads(line.removeprefix(_MARK)) for line in text.splitlines() if line.startswith(_MARK)]
    if len(came) != sum(map(len, composition.parts)):
        yield f"{len(came)} rows came to their end"
    for place, number, took, error in came:
        row = composition.parts[place][number]
        seconds, slack = took / SECOND, 1e-6 if row.does in _EXACT else _SLACK
        if (row.does is Does.REFUSED) is not error.startswith("NotImplementedError"):
            yield f"{row.call} ended with {error or 'nothing'}"
        elif not row.takes - 1e-6 <= seconds <= row.takes + slack:
            yield f"{row.call} took {seconds} s of virtual time"
    told = any(isinstance(event, Notice) and event.unrepeatable for event in run.events)
    holds = {row.call for part in composition.parts for row in part if row.does in {Does.HOLDS, Does.NEW}}
    if not holds if told else holds - _SELDOM_HOLD:
        yield "it says that it is not repeatable" if told else "it does not say that it is not repeatable"


def main() -> int:
    """Try seeds until the time is up; returns the exit code: 0 all well, 1 not, 130 interrupted."""
    parser = argparse.ArgumentParser(prog="python -m tests.soak.stdlib_calls", description=__doc__)
    parser.add_argument("--minutes", type=float, default=3.0, help="how long (%(default)s)")
    parser.add_argument("--seed", type=int, default=1, help="the first seed (%(default)s)")
    parser.add_argument("--processes", type=int, default=2, help="programs at once (%(default)s)")
    parser.add_argument("--record", action="store_true", help=f"put what came of it into {FILE.name}")
    options = parser.parse_args()
    began, programs, troubles, ended = time.monotonic(), 0, 0, "interrupted"
    with until_interrupted(), ThreadPoolExecutor(options.processes) as pool:
        while time.monotonic() - began < options.minutes * 60:
            first = options.seed + programs
            for found in pool.map(troubles_of, range(first, first + options.processes)):
                programs += 1
                troubles += bool(found)
                sys.stderr.writelines(f"{trouble}\n" for trouble in found)
        ended = "done"
    seconds = round(time.monotonic() - began)
    sys.stdout.write(
        f"{ended}: {programs} programs twice from seed {options.seed}, {troubles} in trouble, {seconds} s\n"
    )
    if options.record:
        figures = {"programs": programs, "seconds": seconds, "troubles": troubles}
        record("stdlib", "calls", {"date": today(), "seed": options.seed, **figures})
    if troubles:
        return 1
    return 0 if ended == "done" else 130


if __name__ == "__main__":
    sys.exit(main())
