"""Which problems of one of two runs are gone in the other, and which are new there."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from cbtui.runs.judged.cures import NOTICED, Problem, name_of, problem_of
from sim.diagnosis import Diagnoses, Weight, sentence
from sim.quantities.plural import counted
from sim.trace.figures.comparison import unlike_commands
from sim.trace.figures.comparison_rows import RUNS
from sim.trace.model import Nanoseconds
from sim.trace.timeline import Timeline


@dataclass(frozen=True)
class _Known:
    """A problem of a run: since when, what to call it, and whether something hangs for ever."""

    at: Nanoseconds
    name: str
    hangs: bool


@dataclass(frozen=True)
class _Problems:
    """The problems of a run, and the names of what is only an effect of one there."""

    known: Mapping[Problem, _Known]
    effects: frozenset[str]


@dataclass(frozen=True)
class ComparedProblems:
    """Tells of the problems of two runs, which may go on meanwhile. Not thread-safe, like their timelines.

    What was only an effect of another problem in the other run is nothing new or gone. Of runs that were not
    given the same commands, nothing is.
    """

    first: Timeline
    second: Timeline
    _diagnoses: tuple[Diagnoses, Diagnoses] = field(default_factory=lambda: (Diagnoses(), Diagnoses()))

    def told(self) -> str:
        """Return sentences, on what hangs first; "" if nothing is gone or new.

        Nothing is said of a problem which the other run has not come to.
        """
        if self._are_unlike:
            return ""
        first, second = self._found()
        return " ".join(filter(None, (self._hangs(first, second), *self._others(first, second))))

    def is_cured(self) -> bool:
        """Return whether problems of the first run are gone in the second one, and none is new there."""
        if self._are_unlike:
            return False
        first, second = self._found()
        gone, new = _only_in(first, second), _only_in(second, first)
        return bool(gone) and not new and _has_come_to(self.second, *gone)

    @property
    def _are_unlike(self) -> bool:
        return bool(unlike_commands(self.first, self.second, min(self.first.end, self.second.end)))

    def _found(self) -> tuple[_Problems, _Problems]:
        first, second = self._diagnoses
        return _problems_of(self.first, first), _problems_of(self.second, second)

    def _hangs(self, *runs: _Problems) -> str:
        first, second = ({key: each for key, each in own.known.items() if each.hangs} for own in runs)
        names = [each.name for each in (*first.values(), *second.values())]
        name = min(names, default="")
        if not first:
            is_new = second and _has_come_to(self.first, *second.values())
            return sentence(f"{RUNS[1]} has a {name} that {RUNS[0]} has not") if is_new else ""
        still, gone = first.keys() & second.keys(), first.keys() - second.keys()
        is_sure = still == second.keys() and gone and _has_come_to(self.second, *map(first.__getitem__, gone))
        if still and is_sure:
            number = "one is" if len(gone) == 1 else f"{len(gone)} are"
            return f"Of {counted(len(first), name)} {number} gone in {RUNS[1]}."
        if still:
            return f"The {name} is still there."
        if second:
            return f"The {name} is gone, but {RUNS[1]} has another one."
        return f"The {name} is gone." if _has_come_to(self.second, *first.values()) else ""

    def _others(self, *runs: _Problems) -> Iterator[str]:
        first, second = ({each.name: each for each in own.known.values() if not each.hangs} for own in runs)
        before, after = ({*own, *of_run.effects} for own, of_run in zip((first, second), runs, strict=True))
        gone = [name for name in first if name not in after and _has_come_to(self.second, first[name])]
        new = [name for name in second if name not in before and _has_come_to(self.first, second[name])]
        for what, names in (("Gone", gone), ("New", new)):
            if names:
                yield f"{what} in {RUNS[1]}: {', '.join(names)}."


def _only_in(one: _Problems, other: _Problems) -> list[_Known]:
    left = one.known.keys() - other.known.keys()
    return [one.known[each] for each in left if one.known[each].name not in other.effects]


def _has_come_to(timeline: Timeline, *problems: _Known) -> bool:
    """Whether a run has come so far that it would have shown these problems of the other one."""
    return timeline.end >= max(each.at for each in problems) + NOTICED


def _problems_of(timeline: Timeline, diagnoses: Diagnoses) -> _Problems:
    found: dict[Problem, _Known] = {}
    effects: set[str] = set()
    for each in diagnoses.update(timeline):
        told = each.explained(timeline)
        if each.weight_in(timeline) is Weight.PROBLEM:
            found[problem_of(each, timeline)] = _Known(each.at, name_of(each, told), told.for_ever)
        elif each.due_to:
            effects.add(name_of(each, told))
    return _Problems(found, frozenset(effects))
