"""Whether real ROS 2 goes as the model: systems that are decided, run on both as often as it takes."""

from collections.abc import Iterable, Iterator
from dataclasses import replace
from enum import Enum
from itertools import repeat
from typing import NamedTuple

from tests.conformance.drawing import drawn
from tests.conformance.programs import program
from tests.conformance.running import Said, run_all
from tests.conformance.steered import Steering
from tests.conformance.systems import System

GAP = 0.05
"""Seconds that any two moments of a system are apart."""
TOLERANCE = 0.05
"""Seconds by which a line of a real run may come at another time than on the model."""
LATE = 0.02
"""Seconds: what a run says is not believed if the machine was so late to wake one of its threads.

On a busy machine all three, and all times of the systems, are longer by a factor, the ``pace``.
"""
FEWEST_LINES = 8
_ALIKE = 1e-5
"""Seconds by which one moment may differ from itself, as programs name times to the microsecond."""


class Outcome(Enum):
    """What comes of comparing a system."""

    SAME = "the same"
    REACHED = "the same, in another order of threads"
    """The model reaches it (``searching``), though not with the order that it takes by itself."""
    ORDER = "other lines, or in another order"
    TIMES = "at other times"
    BUSY = "not known, for the machine was too busy"
    SILENT = "said nothing"


DIFFERENT = (Outcome.ORDER, Outcome.TIMES)


class Case(NamedTuple):
    """A system whose moments are apart, and what the model says of it."""

    seed: str
    system: System
    model: Said
    pace: float = 1.0


class Result(NamedTuple):
    """What came of a case, and what its real runs said."""

    case: Case
    outcome: Outcome
    real: tuple[Said, ...]


def cases(number: int, seed: int, distro: str, pace: float = 1.0) -> list[Case]:
    """So many systems, each ending before two of its moments are so close that they are undecided."""
    found: list[Case] = []
    at = 0
    while len(found) < number:
        seeds = [f"{seed}-{each}" for each in range(at, at + 2 * number)]
        at += len(seeds)
        found += decided(((each, drawn(each).scaled(pace)) for each in seeds), distro, pace)
    return found[:number]


def decided(
    systems: Iterable[tuple[str, System]], distro: str, pace: float = 1.0, fewest_lines: int = FEWEST_LINES
) -> list[Case]:
    """Those of named systems that say enough before they are undecided, and end there."""
    given = list(systems)
    found = []
    for (name, system), said in zip(given, on_model((each for _, each in given), distro), strict=True):
        if said is not None:
            end = _decided_until(said, system.end, GAP * pace)
            case = Case(name, replace(system, end=end), _until(said, end), pace)
            if len(case.model.words) >= fewest_lines:
                found.append(case)
    return found


def _until(said: Said, end: float) -> Said:
    number = sum(at <= end for at in said.times)
    return Said(said.words[:number], said.times[:number], said.moments)


def on_model(
    systems: Iterable[System],
    distro: str,
    steering: Iterable[Steering | None] = repeat(None),
    at_once: int = 12,
) -> Iterator[Said | None]:
    """What the model says of systems, with its usual order of threads, or as each is steered."""
    return run_all(map(program, systems), None, at_once, distro, steering)


def _decided_until(said: Said, end: float, gap: float) -> float:
    moments = [0.0]
    for each in sorted([*said.moments, end]):
        if each - moments[-1] > _ALIKE:
            moments.append(each)
    for before, moment, after in zip(moments, moments[1:], moments[2:], strict=False):
        if moment <= end and after - moment < gap:
            return (before + moment) / 2
    return end


def compared(given: Iterable[Case], python: str, distro: str, at_once: int, repeats: int) -> list[Result]:
    """Run each until it goes as on the model, or ``repeats`` runs that the machine had time for did not.

    Where the machine is too busy, three times as many runs are made at most.
    """
    left = list(given)
    real: dict[Case, list[Said | None]] = {case: [] for case in left}
    for _ in range(3 * repeats):
        runs = run_all([program(case.system) for case in left], python, at_once)
        for case, said in zip(left, runs, strict=True):
            real[case].append(said)
        left = [case for case in left if not _is_settled(case, real[case], repeats)]
        if not left:
            break
    return [
        Result(case, outcome(case, runs), tuple(said for said in runs if said is not None))
        for case, runs in real.items()
    ]


def _is_settled(case: Case, runs: list[Said | None], repeats: int) -> bool:
    return len(_believed(case, runs)) >= repeats or outcome(case, runs) in (Outcome.SAME, Outcome.SILENT)


def _believed(case: Case, runs: list[Said | None]) -> list[Said]:
    return [said for said in runs if said is not None and said.late <= LATE * case.pace]


def outcome(case: Case, runs: list[Said | None]) -> Outcome:
    """What the runs come to: the model has to give one of them."""
    if any(said is not None and _has_same_order(case, said) and _is_in_time(case, said) for said in runs):
        return Outcome.SAME
    if all(said is None for said in runs):
        return Outcome.SILENT
    believed = _believed(case, runs)
    if not believed:
        return Outcome.BUSY
    return Outcome.TIMES if any(_has_same_order(case, said) for said in believed) else Outcome.ORDER


def _has_same_order(case: Case, said: Said) -> bool:
    return words_of(case.system, said) == words_of(case.system, case.model)


def place_of(system: System, line: str) -> int:
    """Whose line it is: the place of an executor."""
    name = line.split(maxsplit=1)[0]
    if "_" not in name:
        return int(name[1:])
    number = int(name.split("_")[1])
    return next(system.nodes[each.node] for each in system.callbacks if each.place == number)


def _lines_of(system: System, said: Said) -> dict[int, list[tuple[str, float]]]:
    """What each executor's callbacks said, and when; between executors only time gives an order."""
    lines: dict[int, list[tuple[str, float]]] = {place: [] for place in range(len(system.executors))}
    for word, at in zip(said.words, said.times, strict=True):
        lines[place_of(system, word)].append((word, at))
    return lines


def words_of(system: System, said: Said) -> dict[int, list[str]]:
    """The lines of each executor's callbacks, in its order."""
    return {place: [word for word, _ in lines] for place, lines in _lines_of(system, said).items()}


def _is_in_time(case: Case, said: Said) -> bool:
    """Whether it said the same lines as the model at the same times, within the tolerance."""
    one, other = _lines_of(case.system, said), _lines_of(case.system, case.model)
    return all(
        abs(at - due) <= TOLERANCE * case.pace
        for place in one
        for (_, at), (_, due) in zip(one[place], other[place], strict=True)
    )
