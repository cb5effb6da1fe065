"""Which problems of one of two runs are gone in the other, and which are new there."""

from collections.abc import Container, Mapping
from dataclasses import dataclass, field
from typing import TypeVar

from cbtui.runs.judged.cures import NOTICED, Problem, name_of, problem_of
from sim.diagnosis import Diagnoses, Weight, sentence
from sim.quantities.durations import timestamp
from sim.quantities.nanoseconds import SECOND
from sim.quantities.plural import counted
from sim.trace.figures.comparison import Comparison, unlike_commands
from sim.trace.figures.comparison_rows import RUNS
from sim.trace.figures.comparison_sentences import NO_PROBLEMS, Problems
from sim.trace.model import Nanoseconds
from sim.trace.timeline import Timeline

KeyT = TypeVar("KeyT")

_ALIKE: Nanoseconds = SECOND // 10
"""By how much the ends of two runs of one length may differ on the real clock."""


@dataclass(frozen=True)
class _Known:
    """A problem of a run: since when, and what to call it."""

    at: Nanoseconds
    name: str


_Hangs = Mapping[Problem, _Known]


@dataclass(frozen=True)
class _Found:
    """The problems of a run: what hangs for ever, the others by name, and the names of mere effects."""

    hangs: _Hangs
    others: Mapping[str, _Known]
    effects: frozenset[str]

    @property
    def names(self) -> frozenset[str]:
        """What is no news in the other run."""
        return self.effects | self.others.keys()


@dataclass(frozen=True)
class ComparedProblems:
    """Tells of the problems of two runs, which may go on meanwhile. Not thread-safe, like their timelines.

    What was only an effect of another problem in the other run is nothing new or gone. Of runs that were not
    given the same commands, nothing is.
    """

    first: Timeline
    second: Timeline
    _diagnoses: tuple[Diagnoses, Diagnoses] = field(default_factory=lambda: (Diagnoses(), Diagnoses()))

    def compared(self, comparison: Comparison | None = None) -> Problems:
        """Tell what is gone, new and still there in the second run, what hangs first.

        Nothing is gone or new that the other run has not come to. What hangs weighs more than the rest. Of
        runs that share little in their ``comparison`` only what each has is told.
        """
        if unlike_commands(self.first, self.second, min(self.first.end, self.second.end)):
            return NO_PROBLEMS
        first, second = found = [*map(_found, (self.first, self.second), self._diagnoses)]
        if comparison is not None and comparison.shares_little:
            names = [
                dict.fromkeys((*(each.name for each in run.hangs.values()), *run.others)) for run in found
            ]
            told = [f"Found in {run}: {', '.join(has)}." for run, has in zip(RUNS, names, strict=True) if has]
            return Problems(" ".join(told))
        gone = _missing(first.others, second.names, self.second)
        new = _missing(second.others, first.names, self.first)
        still = [each.name for name, each in second.others.items() if name in first.names]
        told = [self._hangs(first.hangs, second.hangs)]
        told += [
            f"{what} in {RUNS[1]}: {', '.join(names)}."
            for what, names in (("Gone", gone), ("New", new), ("Still", still))
            if names
        ]
        of_hangs = (
            len(_missing(first.hangs, second.hangs, self.second)),
            len(_missing(second.hangs, first.hangs, self.first)),
        )
        speaks = of_hangs[0] - of_hangs[1] or bool(gone) - bool(new)
        return Problems(
            " ".join(filter(None, told)),
            speaks if gone or new or any(of_hangs) else None,
            bool(first.hangs and second.hangs),
        )

    def _hangs(self, first: _Hangs, second: _Hangs) -> str:
        """Return a sentence on what hangs; "" for nothing."""
        name = min((each.name for each in (*first.values(), *second.values())), default="")
        still, gone = first.keys() & second.keys(), first.keys() - second.keys()
        if not (first and second):
            return self._hangs_in_one(name, first, second)
        is_sure = still == second.keys() and len(_missing(first, second, self.second)) == len(gone) > 0
        if still and is_sure:
            number = "one is" if len(gone) == 1 else f"{len(gone)} are"
            return f"Of {counted(len(first), name)} {number} gone in {RUNS[1]}."
        if still:
            return f"The {name} is still there."
        return f"The {name} is gone, but {RUNS[1]} has another one."

    def _hangs_in_one(self, name: str, first: _Hangs, second: _Hangs) -> str:
        if not (first or second):
            return ""
        has, other = (self.first, self.second) if first else (self.second, self.first)
        if len(_missing({**first, **second}, (), other)) == len(first or second):
            is_new = f"{RUNS[1]} has a {name} that {RUNS[0]} has not"
            return f"The {name} is gone." if first else sentence(is_new)
        if other.end + _ALIKE < has.end:
            return ""
        one, none = RUNS if first else RUNS[::-1]
        return sentence(f"{one} has a {name}, {none} shows none up to {timestamp(other.end)}")


def _missing(known: Mapping[KeyT, _Known], other: Container[KeyT], run: Timeline) -> list[str]:
    """The names of problems that the other run has not, though it has come so far that it would show them."""
    missing = (each for key, each in known.items() if key not in other)
    return [each.name for each in missing if run.end >= each.at + NOTICED]


def _found(timeline: Timeline, diagnoses: Diagnoses) -> _Found:
    hangs: dict[Problem, _Known] = {}
    others: dict[str, _Known] = {}
    effects: set[str] = set()
    for each in diagnoses.update(timeline):
        told = each.explained(timeline)
        name = name_of(each, told)
        known = _Known(each.at, name)
        if each.weight_in(timeline) is not Weight.PROBLEM:
            effects.update([name] if each.due_to else [])
        elif told.for_ever:
            hangs[problem_of(each, timeline)] = known
        else:
            others[name] = known
    return _Found(hangs, others, frozenset(effects))
