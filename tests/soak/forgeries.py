"""Hands in forgeries, several in one program at random, and looks that nobody gets or loses marks by them.

``python -m tests.soak.forgeries --minutes 3 --seed 1`` grades classes, with ``bwrap`` and without it in
turns. A class is chosen by the seed and its number. ``--record`` keeps what came of it.
"""

import argparse
import shutil
import sys
import tempfile
import time
from collections.abc import Iterator
from itertools import count
from pathlib import Path
from random import Random

from tests.grading.classroom import NEIGHBOURS, Classroom, Graded
from tests.grading.forgeries import ENDING, IN_VAIN, ON_THE_TRACE, REACHING_OUT, STARTER
from tests.soak.results import FILE, record, today

_LEARNERS = 4
_LIMIT = 10
_ALL = {**REACHING_OUT, **ON_THE_TRACE, **IN_VAIN}


def main() -> int:
    """Grade classes; returns the exit code: 0 all well, 1 some marks are wrong."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=3, help="for how long (%(default)s)")
    parser.add_argument("--seed", type=int, default=1, help="what chooses the classes (%(default)s)")
    parser.add_argument("--record", action="store_true", help=f"put what came of it into {FILE.name}")
    options = parser.parse_args()
    began = time.monotonic()
    forgeries = wrong = 0
    for number in count():
        if time.monotonic() > began + 60 * options.minutes:
            break
        troubles = list(troubles_of(options.seed, number))
        for trouble in troubles:
            sys.stdout.write(f"class {number}: {trouble}\n")
        forgeries, wrong = forgeries + _LEARNERS, wrong + len(troubles)
    seconds = round(time.monotonic() - began)
    sys.stdout.write(
        f"seed {options.seed}: {number} classes, {forgeries} forgeries, {wrong} wrong, {seconds} s\n"
    )
    if options.record:
        figures = {"classes": number, "forgeries": forgeries, "seconds": seconds, "wrong": wrong}
        record("forgeries", "classes", {"date": today(), "seed": options.seed, **figures})
    return 1 if wrong else 0


def troubles_of(seed: int, number: int) -> Iterator[str]:
    """Grade one class; yield a sentence on everything that is not as it should be."""
    random = Random(f"{seed} {number}")
    confined = number % 2 == 0 and shutil.which("bwrap") is not None
    with tempfile.TemporaryDirectory() as place:
        classroom = Classroom(Path(place), confined=confined)
        handed_in = {f"forger {each}": _forgery(random) for each in range(_LEARNERS)}
        for learner, (_, source) in handed_in.items():
            classroom.hand_in(learner, source)
        if confined and random.random() < 0.5:
            classroom.hand_in("forger 0", ENDING[random.choice([*ENDING])])
        graded = classroom.grade(limit=_LIMIT)
        if confined and graded.err:
            yield f"it was not confined, or fell over: {graded.err}"
        yield from _wrong(graded, handed_in)


def _forgery(random: Random) -> tuple[str, str]:
    """Two forgeries in one program, or one; and what they are called."""
    names = random.sample([*_ALL], random.choice([1, 1, 2]))
    sources = [_ALL[name].removesuffix(STARTER) for name in names]
    if _ALL[names[-1]].endswith(STARTER):
        sources.append(STARTER)
    return " and ".join(names), "\n".join(sources)


def _wrong(graded: Graded, handed_in: dict[str, tuple[str, str]]) -> Iterator[str]:
    if "Traceback" in graded.err:
        yield f"the grader fell over: {graded.err}"
    for learner in NEIGHBOURS:
        row = graded.rows.get(learner)
        if row is None or (row["passed"], row["suspicious"]) != ("1", ""):
            yield f"{learner} has {row} beside {[name for name, _ in handed_in.values()]}"
    for learner, (name, _) in handed_in.items():
        row = graded.rows.get(learner)
        if row is None or row["passed"] != "0":
            yield f"{name!r} has {row}"


if __name__ == "__main__":
    sys.exit(main())
