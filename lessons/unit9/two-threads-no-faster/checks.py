"""What a run of this lesson shows, and what a mended node must do.

The run is on the real clock, on a computer that may be busy. So nothing
here asks how quick something was, but by how much bars overlap, and how
much of the time was computing.
"""

import re

from lessons.checks import (
    SECOND,
    Check,
    Verdict,
    calls_of,
    log_says,
    never_raises,
    no_problem,
    seconds,
)
from sim.trace.model import Span
from sim.trace.timeline import Timeline

DESKS = ("left_desk", "right_desk")
COMPUTED = re.compile(r"(left|right) took .*, computed (\d+\.\d+) s")
AT_ONCE = 0.15
"""Seconds in which a desk hands a job on, even if the computer is busy."""


def _pair(run: Timeline, job: str) -> list[Span]:
    """The bars of the first two jobs of a kind, one of each desk."""
    handed_out = [line.text for line in run.logs if "Two jobs" in line.text]
    number = next(
        (n for n, text in enumerate(handed_out) if text.endswith(job)), 0
    )
    calls = [calls_of(run, desk)[number : number + 1] for desk in DESKS]
    return [span for of_desk in calls for span in of_desk]


def _length(run: Timeline, spans: list[Span]) -> float:
    """Seconds from the first begin to the last end."""
    begin = min(span.start for span in spans)
    return (max(span.end_at(run.end) for span in spans) - begin) / SECOND


def when_both_have_computed(run: Timeline) -> int:
    """Whether the pair took as long as one job, as both, or between."""
    pair = _pair(run, "compute")
    of_pair = {span.entity for span in pair}
    lines = [
        line for line in run.logs if getattr(line, "entity", 0) in of_pair
    ]
    found = (COMPUTED.search(line.text) for line in lines)
    computed = [float(match[2]) for match in found if match]
    share = _length(run, pair) / max(sum(computed[:2]), 0.01)
    if share < 0.65:
        return 0
    return 1 if share < 0.9 else 2


def when_both_have_waited(run: Timeline) -> int:
    """Whether the two waited at the same time, or one after the other."""
    pair = _pair(run, "wait")
    alone = sum(span.end_at(run.end) - span.start for span in pair) / SECOND
    return 0 if _length(run, pair) < 0.9 * alone else 1


def _judge_desks(run: Timeline) -> Verdict:
    expected = f"a return within {seconds(round(AT_ONCE * SECOND))}"
    pair = _pair(run, "compute")
    if len(pair) < len(DESKS):
        return Verdict(False, expected, "not two desks that compute")
    slowest = max(pair, key=lambda span: span.end_at(run.end) - span.start)
    took = slowest.end_at(run.end) - slowest.start
    seen = f"{run.entities[slowest.entity].callback} took {seconds(took)}"
    return Verdict(took <= AT_ONCE * SECOND, expected, seen, slowest.start)


CHECKS = (
    Check("a desk that is to compute returns at once", _judge_desks),
    log_says("adds up to", at_least=2),
    no_problem("group-starvation"),
    never_raises(),
)
