"""Gives readers of files, lines and messages inputs that nobody would write: ``python -m tests.soak.fuzz``.

``[TARGET…] --inputs N --seed S`` spreads so many inputs over the targets and prints a line for each. An input
that crashes is kept in ``tests/soak/found``; ``TARGET --again FILE`` gives it once more, with its traceback.
"""

import argparse
import sys
from pathlib import Path

from tests.soak.fuzz_runs import Outcome, again, fuzz, keep
from tests.soak.fuzz_targets import TARGETS
from tests.soak.results import FILE, record, today


def main() -> int:
    """Fuzz the targets; returns the exit code: 0 all well, 1 something crashed."""
    options = _parse()
    if options.again is not None:
        return _again(options.targets[0], options.again)
    outcomes = []
    for name in options.targets or list(TARGETS):
        outcome = fuzz(TARGETS[name](), options.inputs // len(options.targets or TARGETS), options.seed)
        outcomes.append(outcome)
        sys.stdout.write(f"{line_of(outcome)}\n")
        for crash, path in keep(outcome):
            sys.stdout.write(
                f"    {crash.what} at {crash.where}; python -m tests.soak.fuzz {name} --again {path}\n"
            )
        sys.stdout.flush()
        if options.record:
            record("fuzz", name, entry_of(outcome, options.seed))
    crashed = sum(outcome.crashed for outcome in outcomes)
    inputs, seconds = (sum(getattr(each, name) for each in outcomes) for name in ("inputs", "seconds"))
    sys.stdout.write(f"{inputs:,} inputs (seed {options.seed}) in {seconds:.0f} s, {crashed} crashed\n")
    return 1 if crashed else 0


def line_of(outcome: Outcome) -> str:
    """What came of a target, on one line."""
    return (
        f"{outcome.target:<13} {outcome.inputs:>9,} inputs {outcome.seconds:>7.1f} s  "
        f"{outcome.refused:>8,} refused {outcome.accepted:>8,} taken {outcome.crashed:>5} crashed"
    )


def entry_of(outcome: Outcome, seed: int) -> dict[str, str | int | float]:
    """What is recorded of a target."""
    return {
        "date": today(),
        "seed": seed,
        "inputs": outcome.inputs,
        "seconds": round(outcome.seconds, 1),
        "refused": outcome.refused,
        "taken": outcome.accepted,
        "crashed": outcome.crashed,
    }


def _again(name: str, path: Path) -> int:
    target, data = TARGETS[name](), path.read_bytes()
    told = again(target, data)
    sys.stdout.write(f"{told}\n")
    return 1 if isinstance(told, tuple) else 0


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.soak.fuzz", description=__doc__)
    parser.add_argument("targets", nargs="*", metavar="TARGET", help=f"of {', '.join(TARGETS)} (all)")
    parser.add_argument("--inputs", type=int, default=100_000, help="how many in all (%(default)s)")
    parser.add_argument("--seed", type=int, default=0, help="which inputs; the same seed, the same inputs")
    parser.add_argument("--again", type=Path, metavar="FILE", help="give the target what is in a file")
    parser.add_argument("--record", action="store_true", help=f"put what came of it into {FILE.name}")
    options = parser.parse_args()
    if unknown := [name for name in options.targets if name not in TARGETS]:
        parser.error(f"there is no target {unknown[0]}; there are {', '.join(TARGETS)}")
    if options.again is not None and len(options.targets) != 1:
        parser.error("--again needs the one target that the file is for")
    return options


if __name__ == "__main__":
    sys.exit(main())
