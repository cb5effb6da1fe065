"""Every lesson for virtual hours, then the console for real minutes: ``python -m tests.soak.lessons``.

``--hours 30 --minutes 20 --seed S`` runs the lessons in turn, headless, with threads, groups, periods, rates,
calls, ros2 lines and orders of threads at random, each run twice, which has to give the same bytes; messages
are followed to their end, and each engine's memory, threads and files are watched. Then keys are pressed at
random, and the console's own are watched. A line now and then tells how far it is; the last one what came
of it, also after ctrl+c. ``--run N`` makes the run of that number alone, once more.
"""

import argparse
import gc
import sys
import time
from collections.abc import Iterable
from dataclasses import dataclass, field

from tests.soak.footprint import Footprint, footprint, growth
from tests.soak.interruption import until_interrupted
from tests.soak.lesson_runs import SECOND, choose, run_twice
from tests.soak.results import FILE, Entry, record, today
from tests.soak.walks import walk

_NEWS = 10.0
"""Real seconds from one line on how far it is to the next."""
_WALK = 150
_MEMORY = 30_000_000
_ALLOWED = {"memory": _MEMORY, "threads": 2, "files": 4}
"""By how much this process may grow from the middle of a soak to its end."""


@dataclass
class Soak:
    """What a soak came to so far."""

    seed: int
    runs: int = 0
    virtual: float = 0.0
    events: int = 0
    messages: int = 0
    walks: int = 0
    steps: int = 0
    in_vain: int = 0
    troubles: int = 0
    run_troubles: int = 0
    running: float = 0.0
    walking: float = 0.0
    footprints: list[Footprint] = field(default_factory=list)
    _told: float = 0.0

    def run_lessons(self, hours: float, longest: float, first: int = 0) -> None:
        """Run lessons till so many virtual hours are over, each counted once."""
        while self.virtual < hours * 3600:
            number = first + self.runs
            began = time.monotonic()
            came = run_twice(choose(self.seed, number, longest))
            self.running += time.monotonic() - began
            self.runs += 1
            self.virtual += max(came.length / SECOND, 0.1)
            self.events += came.events
            self.messages += came.messages
            self._complain(f"run {number} ({came.title})", came.troubles)
            self.run_troubles = self.troubles
            self._look(f"{self.virtual / 3600:.2f} of {hours:g} h in {self.runs} runs, {came.title}")

    def press_keys(self, minutes: float) -> None:
        """Walk through the console till so many real minutes are over."""
        self.judge_growth("the runs")
        self.run_troubles = self.troubles
        began = time.monotonic()
        while self.walking < minutes * 60:
            done = walk(self.seed, self.walks, _WALK)
            self.walking = time.monotonic() - began
            self.walks += 1
            self.steps += len(done.steps)
            self.in_vain += done.in_vain
            self._complain(f"walk {self.walks - 1} from {done.name}", filter(None, [done.trouble]))
            self._look(
                f"{self.walking / 60:.1f} of {minutes:g} min, {self.steps} steps in {self.walks} walks"
            )
        self.judge_growth("the console")

    def line(self, ended: str) -> str:
        """All that it came to, on one line."""
        speed = 2 * self.virtual / self.running if self.running else 0
        return (
            f"{ended}: seed {self.seed}, {self.virtual / 3600:.2f} virtual h twice in {self.runs} runs "
            f"({speed:.0f} times real time), {self.events:,} events, {self.messages:,} messages followed; "
            f"{self.steps:,} steps in {self.walks} walks, {self.walking / 60:.1f} min; "
            f"{self.troubles} in trouble"
        )

    def _look(self, where: str) -> None:
        gc.collect()
        now = footprint()
        if now is not None:
            self.footprints.append(now)
        if now is not None and time.monotonic() - self._told > _NEWS:
            self._told = time.monotonic()
            _say(
                f"{where}; here {now.memory / 1e6:.0f} MB, {now.threads} threads, {now.files} files; "
                f"{self.troubles} in trouble"
            )

    def judge_growth(self, what: str) -> None:
        """See whether this process has grown meanwhile, and begin anew."""
        grown = {name: growth([getattr(each, name) for each in self.footprints]) for name in _ALLOWED}
        self.footprints.clear()
        self._complain(what, (f"{name} grew by {by:g}" for name, by in grown.items() if by > _ALLOWED[name]))

    def _complain(self, where: str, troubles: Iterable[str]) -> None:
        said = "; ".join(troubles)
        if said:
            self.troubles += 1
            _say(f"{where}: {said}")


def main() -> int:
    """Run, walk, and tell what came of it; returns the exit code: 0 all well, 1 not, 130 interrupted."""
    options = _parse()
    soak = Soak(options.seed)
    ended = "interrupted"
    with until_interrupted():
        if options.run is not None:
            soak.run_lessons(1e-9, options.longest, options.run)
        else:
            soak.run_lessons(options.hours, options.longest)
            soak.press_keys(options.minutes)
        ended = "done"
    if ended != "done":
        soak.judge_growth("what was done")
    sys.stdout.write(f"{soak.line(ended)}\n")
    if options.record:
        _record(soak)
    if soak.troubles:
        return 1
    return 0 if ended == "done" else 130


def _record(soak: Soak) -> None:
    """Keep what came of the runs, and of the walks, if there were any."""
    common: Entry = {"date": today(), "seed": soak.seed}
    if soak.runs:
        figures = {"hours": round(soak.virtual / 3600, 2), "runs": soak.runs, "events": soak.events}
        more = {"messages": soak.messages, "seconds": round(soak.running), "troubles": soak.run_troubles}
        record("lessons", "runs", {**common, **figures, **more})
    if soak.walks:
        walked = {"minutes": round(soak.walking / 60, 1), "walks": soak.walks, "steps": soak.steps}
        came = {"in_vain": soak.in_vain, "troubles": soak.troubles - soak.run_troubles}
        record("lessons", "walks", {**common, **walked, **came})


def _say(line: str) -> None:
    sys.stderr.write(f"{line}\n")
    sys.stderr.flush()


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.soak.lessons", description=__doc__)
    parser.add_argument("--hours", type=float, default=1.0, help="virtual hours of lessons (%(default)s)")
    parser.add_argument("--minutes", type=float, default=5.0, help="real minutes of keys (%(default)s)")
    parser.add_argument(
        "--longest", type=float, default=1800.0, help="seconds of a run at most (%(default)s)"
    )
    parser.add_argument("--seed", type=int, default=0, help="what is done; the same seed, the same runs")
    parser.add_argument("--run", type=int, metavar="N", help="make this run alone")
    parser.add_argument("--record", action="store_true", help=f"put what came of it into {FILE.name}")
    return parser.parse_args()


if __name__ == "__main__":
    sys.exit(main())
