"""What a run of this lesson shows, and what a mended node must do."""

import re
from itertools import pairwise

from lessons.checks import (
    SECOND,
    Check,
    Verdict,
    calls_of,
    entities_named,
    is_called_often,
    never_overlap,
    never_raises,
    no_problem,
)
from sim.trace.events import GroupKind
from sim.trace.timeline import Timeline

WRITES = re.compile(r"writes (\d+)")


def _written(run: Timeline) -> list[tuple[int, int]]:
    """The counts that were written, each with its moment."""
    found = ((line.t, WRITES.search(line.text)) for line in run.logs)
    return [(at, int(match[1])) for at, match in found if match]


def _judge_count(run: Timeline) -> Verdict:
    expected = "one more with each call"
    written = _written(run)
    if not written:
        return Verdict(False, expected, "no line 'writes'")
    for place, (at, count) in enumerate(written, start=1):
        if count != place:
            seen = f"call {place} writes {count}"
            return Verdict(False, expected, seen, at)
    return Verdict(True, expected, f"{len(written)} calls, all counted")


def _judge_group(run: Timeline) -> Verdict:
    expected = "an exclusive group"
    entities = [run.entities[each] for each in entities_named(run, "inspect")]
    if not entities:
        return Verdict(False, expected, "no callback of that name")
    group = run.groups[entities[0].group]
    passed = group.kind is GroupKind.EXCLUSIVE
    return Verdict(passed, expected, f"a {group.class_name}")


CHECKS = (
    Check("every call of inspect is counted", _judge_count),
    Check("inspect has a group that keeps it from overlapping", _judge_group),
    never_overlap("inspect"),
    no_problem("overrun-timer", "inspect misses no tick"),
    is_called_often("inspect", 8),
    never_raises(),
)


def what_the_ticks_do(run: Timeline) -> int:
    """Whether calls follow one another on time, late, or overlap."""
    calls = calls_of(run, "inspect")
    if any(two.start < one.end_at(run.end) for one, two in pairwise(calls)):
        return 2
    return 1 if max(call.age for call in calls) > SECOND // 20 else 0


def what_the_count_says(run: Timeline) -> int:
    """Whether all calls were counted, half of them, or a third."""
    written = _written(run)
    share = written[-1][1] / len(written)
    if share > 0.8:
        return 0
    return 1 if share > 0.45 else 2
