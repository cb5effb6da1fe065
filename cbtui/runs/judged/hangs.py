"""What hangs in one of two runs: whether a deadlock, or another wait without end, is gone in the other."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from cbtui.runs.judged.cures import Problem, problem_of
from sim.diagnosis import HANGS, Diagnoses, sentence
from sim.quantities.nanoseconds import SECOND
from sim.trace.figures.comparison_rows import RUNS
from sim.trace.model import Nanoseconds
from sim.trace.timeline import Timeline

_NOTICED: Nanoseconds = 2 * SECOND
"""How long after it a wait without end is known as one."""


@dataclass(frozen=True)
class _Hang:
    """Since when something hangs, and what to call it."""

    at: Nanoseconds
    name: str


@dataclass(frozen=True)
class ComparedHangs:
    """Tells what hangs in two runs, which may go on meanwhile. Not thread-safe, like their timelines."""

    first: Timeline
    second: Timeline
    _diagnoses: tuple[Diagnoses, Diagnoses] = field(
        default_factory=lambda: (Diagnoses(HANGS), Diagnoses(HANGS))
    )

    def told(self) -> str:
        """Return a sentence; "" if nothing hangs, or if the second run has not come that far."""
        first, second = (
            _hangs_of(timeline, diagnoses)
            for timeline, diagnoses in zip((self.first, self.second), self._diagnoses, strict=True)
        )
        names = [each.name for each in (*first.values(), *second.values())]
        name = min(names, default="")
        if not first:
            return sentence(f"{RUNS[1]} has a {name} that {RUNS[0]} has not") if second else ""
        if first.keys() & second.keys():
            return f"The {name} is still there."
        if second:
            return f"The {name} is gone, but {RUNS[1]} has another one."
        is_known = self.second.end >= max(each.at for each in first.values()) + _NOTICED
        return f"The {name} is gone." if is_known else ""


def _hangs_of(timeline: Timeline, diagnoses: Diagnoses) -> Mapping[Problem, _Hang]:
    found: dict[Problem, _Hang] = {}
    for each in diagnoses.update(timeline):
        told = each.rule.explain(each, timeline)
        if told.for_ever:
            name = "deadlock" if each.waited_for or "deadlock" in told.what else "hang"
            found[problem_of(each, timeline)] = _Hang(each.at, name)
    return found
