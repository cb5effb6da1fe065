"""Generated systems on real rclpy and on the model: ``python -m tests.conformance --systems 50 --seed 1``."""

import argparse
import sys
from collections import Counter
from pathlib import Path

from cbtui.commands.options.changes import release_of
from tests.conformance.comparing import DIFFERENT, Outcome, Result, cases, compared
from tests.conformance.programs import program
from tests.conformance.recorded import record
from tests.conformance.searching import searched
from tests.conformance.shrinking import shrunk


def main() -> None:
    """Run, and tell what differs; the exit code is 1 if anything does."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--systems", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--python", action="append", help="an interpreter with ROS 2, once for each")
    parser.add_argument("--at-once", type=int, default=3, help="real programs that run at a time")
    parser.add_argument(
        "--pace", type=float, default=1.0, help="all times are so many times as long, on a busy machine"
    )
    parser.add_argument("--shrink", action="store_true", help="find the smallest system that still differs")
    parser.add_argument("--repeats", type=int, default=4, help="real runs before a difference is believed")
    parser.add_argument(
        "--runs", type=int, default=240, help="runs of the model in search of what a real one said"
    )
    parser.add_argument("--record", type=int, default=0, help="keep so many for the daily suite")
    parser.add_argument("--keep", type=Path, help="a folder for the programs that differ")
    options = parser.parse_args()
    wrong = 0
    for python in options.python or [sys.executable]:
        distro = release_of(python)
        assert distro is not None
        given = cases(options.systems, options.seed, distro, options.pace)
        print(
            f"{distro}: {len(given)} systems, {sum(len(case.model.words) for case in given)} lines",
            flush=True,
        )
        results = compared(given, python, distro, options.at_once, options.repeats)
        results = searched(results, distro, options.runs)
        for outcome, number in Counter(result.outcome for result in results).most_common():
            print(f"{number:5} {outcome.value}", flush=True)
        if options.record:
            same = [each for each in results if each.outcome is Outcome.SAME]
            record(distro, same[: options.record])
        for each in results:
            if each.outcome not in (Outcome.SAME, Outcome.REACHED):
                wrong += 1
                result = each
                if options.shrink and each.outcome in DIFFERENT:
                    result = shrunk(each, python, distro, options.at_once, options.repeats, options.runs)
                _tell(result)
                if options.keep:
                    options.keep.mkdir(parents=True, exist_ok=True)
                    file = options.keep / f"{distro}-{result.case.seed}.py"
                    file.write_text(program(result.case.system))
            elif each.outcome is Outcome.REACHED:
                print(f"  {each.case.seed}: {each.outcome.value}")
    sys.exit(bool(wrong))


def _tell(result: Result) -> None:
    case = result.case
    print(
        f"  {case.seed}: {result.outcome.value}; executors {case.system.executors}, nodes {case.system.nodes}"
    )
    if not result.real:
        return
    real = result.real[-1]
    pairs = zip(real.words, case.model.words, strict=False)
    shorter = min(len(real.words), len(case.model.words))
    place = next((i for i, (one, other) in enumerate(pairs) if one != other), shorter - 1)
    for name, said in (("real", real), ("model", case.model)):
        shown = list(zip(said.times, said.words, strict=True))[max(place - 1, 0) : place + 3]
        print(f"    {name:6}", "; ".join(f"{at:.3f} {what}" for at, what in shown))


if __name__ == "__main__":
    main()
