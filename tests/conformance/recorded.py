"""What real ROS 2 said of some systems, kept so that the model is compared with it where there is none."""

from pathlib import Path
from typing import NamedTuple

import msgspec

from tests.conformance.comparing import Case, Result, on_model, outcome, words_of
from tests.conformance.running import Said
from tests.conformance.steered import Steering
from tests.conformance.systems import System

FILE = Path(__file__).with_name("recorded.jsonl")


class Recorded(NamedTuple):
    """A system, and what its runs on the wheels of a distribution said.

    ``runs`` is how many runs of the model come to that, of many orders; 0: its usual order is the same.
    ``moves``: at which of its choices a run that follows the lines takes which option, and the first one at
    all others, to come to it at once; ``races``: whether the threads of pools race in that; ``stalls``:
    before which of these choices the machine stalls, and for how many nanoseconds.
    """

    distro: str
    seed: str
    pace: float
    system: System
    real: tuple[Said, ...]
    runs: int = 0
    moves: tuple[tuple[int, int], ...] = ()
    races: bool = True
    stalls: tuple[tuple[int, int], ...] = ()

    def steering(self) -> Steering | None:
        """What a run of the model that follows the lines chooses; None: its usual order."""
        if not self.moves:
            return None
        others = dict(self.moves)
        (real,) = self.real
        lines = [*words_of(self.system, real).values()]
        chosen = [others.get(place, 0) for place in range(max(others) + 1)]
        return Steering(chosen, None, lines, self.races, self.stalls)


def record(distro: str, results: list[Result], runs: int = 0) -> None:
    """Keep what real runs said, beside what is kept already."""
    with FILE.open("ab") as file:
        for each in results:
            kept = Recorded(distro, each.case.seed, each.case.pace, each.case.system, each.real, runs)
            file.write(msgspec.json.encode(kept) + b"\n")


def against_recorded(searched: bool) -> list[tuple[Recorded, Result]]:
    """How one run of the model compares with each that is kept: with its choices, or in the usual order.

    ``searched``: those that the model comes to in another order than its usual one.
    """
    kept = [msgspec.json.decode(line, type=Recorded) for line in FILE.read_bytes().splitlines()]
    kept = [each for each in kept if (each.runs > 0) == searched]
    results = []
    for distro in sorted({each.distro for each in kept}):
        of_distro = [each for each in kept if each.distro == distro]
        runs = on_model([each.system for each in of_distro], distro, [each.steering() for each in of_distro])
        for each, said in zip(of_distro, runs, strict=True):
            assert said is not None
            case = Case(each.seed, each.system, said, each.pace)
            results.append((each, Result(case, outcome(case, list(each.real)), each.real)))
    return results
