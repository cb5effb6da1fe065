"""What a run of this lesson shows, and what a mended node must do."""

import re

from lessons.checks import (
    Check,
    Verdict,
    every_call_answered,
    is_called_often,
    never_raises,
)
from sim.trace.events import Severity
from sim.trace.timeline import Timeline

FUSED = re.compile(r"FUSED, (\d+\.\d+) s apart")
MOST = 0.1
"""Seconds between a picture and its scan."""


def _fused(run: Timeline) -> list[tuple[int, float]]:
    """When something was fused, and how many seconds the two were apart."""
    found = ((line.t, FUSED.search(line.text)) for line in run.logs)
    return [(at, float(match[1])) for at, match in found if match]


def _judge_rate(run: Timeline) -> Verdict:
    fused = _fused(run)
    at = fused[0][0] if fused else None
    return Verdict(
        len(fused) >= 45, "at least 45 pairs in 15 s", str(len(fused)), at
    )


def _judge_distance(run: Timeline) -> Verdict:
    expected = f"at most {MOST:g} s"
    fused = _fused(run)
    if not fused:
        return Verdict(False, expected, "no pair")
    at, most = max(fused, key=lambda pair: pair[1])
    return Verdict(most <= MOST, expected, f"{most:.3f} s", at)


CHECKS = (
    Check("pictures and scans are fused", _judge_rate),
    Check("the two lie close together", _judge_distance),
    is_called_often("take_picture", 145),
    is_called_often("take_scan", 58),
    every_call_answered(),
    never_raises(),
)


def how_often_it_fuses(run: Timeline) -> int:
    """Whether each scan is fused, some are, or none."""
    fused = len(_fused(run))
    if not fused:
        return 2
    return 0 if fused >= 45 else 1


def who_tells_you(run: Timeline) -> int:
    """Whether an error ends the program, something warns, or neither."""
    if run.ended is not None and run.ended.failed:
        return 0
    return (
        1
        if any(line.severity is not Severity.INFO for line in run.logs)
        else 2
    )
