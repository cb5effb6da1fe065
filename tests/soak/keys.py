"""Presses, types, clicks and resizes at random for long: ``python -m tests.soak.keys --steps N --seed S``.

Lines tell how far it is; the last one says how much was tried and which screens were reached, also after
ctrl+c. A walk that broke something is told with its last steps; ``--walk`` goes on that one alone, once more.
``--record`` keeps what came of it.
"""

import argparse
import sys
import time
from collections import Counter
from dataclasses import dataclass, field

from tests.soak.interruption import until_interrupted
from tests.soak.results import FILE, record, today
from tests.soak.walks import Walk, walk

_NEWS = 10.0
"""Real seconds from one line on how far it is to the next."""
_TOLD = 12
"""How many of the last steps of a walk are told."""


def main() -> int:
    """Walk until the steps are done; return 1 if anything broke, 130 if it was interrupted."""
    options = _parse()
    tally = _Tally()
    began = time.monotonic()
    ended = False
    with until_interrupted():
        _walk_on(options, tally)
        ended = True
    print(f"{'' if ended else 'interrupted: '}{tally.steps} steps in {tally.walks} walks", end=" ")
    print(f"(seed {options.seed}), {tally.failures} broke something;", end=" ")
    print(f"begun at {_counted(tally.begun)}; reached {_counted(tally.reached)}")
    if options.record:
        _record(tally, options.seed, time.monotonic() - began)
    if tally.failures:
        return 1
    return 0 if ended else 130


@dataclass
class _Tally:
    """What the walks came to so far."""

    steps: int = 0
    walks: int = 0
    failures: int = 0
    in_vain: int = 0
    reached: Counter[str] = field(default_factory=Counter)
    begun: Counter[str] = field(default_factory=Counter)


def _walk_on(options: argparse.Namespace, tally: _Tally) -> None:
    told = time.monotonic()
    while tally.steps < options.steps:
        number = tally.walks if options.walk is None else options.walk
        done = walk(options.seed, number, options.steps)
        tally.steps += max(len(done.steps), 1)
        tally.in_vain += done.in_vain
        tally.reached += done.reached
        tally.begun[done.name] += 1
        tally.walks += 1
        if done.trouble is not None:
            tally.failures += 1
            print(_told(done, number), file=sys.stderr, flush=True)
        if time.monotonic() - told > _NEWS:
            told = time.monotonic()
            print(
                f"{tally.steps} of {options.steps} steps, {tally.failures} broke", file=sys.stderr, flush=True
            )
        if options.walk is not None:
            break


def _record(tally: _Tally, seed: int, seconds: float) -> None:
    figures = {"steps": tally.steps, "walks": tally.walks, "seconds": round(seconds)}
    came = {"in_vain": tally.in_vain, "broke": tally.failures}
    record("keys", "walks", {"date": today(), "seed": seed, **figures, **came})


def _told(done: Walk, number: int) -> str:
    last = ", ".join(map(repr, done.steps[-_TOLD:]))
    return f"walk {number} from {done.name}, {len(done.steps)} steps, the last {last}: {done.trouble}"


def _counted(counter: Counter[str]) -> str:
    return ", ".join(f"{name} {count}" for name, count in counter.most_common())


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.soak.keys", description=__doc__)
    parser.add_argument("--steps", type=int, default=2000, help="how much is done in all (%(default)s)")
    parser.add_argument("--seed", type=int, default=0, help="what is done; the same seed, the same steps")
    parser.add_argument("--walk", type=int, help="go on this walk alone")
    parser.add_argument("--record", action="store_true", help=f"put what came of it into {FILE.name}")
    return parser.parse_args()


if __name__ == "__main__":
    raise SystemExit(main())
