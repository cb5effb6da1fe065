"""What a run of this lesson shows, and what mended scales must do."""

from lessons.checks import (
    SECOND,
    Check,
    Verdict,
    entities_named,
    is_called_often,
    never_raises,
    whole_run,
)
from sim.trace.events import Logged, Severity
from sim.trace.model import Span
from sim.trace.timeline import Timeline

EXPECTED = "an error line for each bad label"
BAD_LABELS = 3


def _judge_errors(run: Timeline) -> Verdict:
    """Count the lines that tell of an error."""
    lines = [
        line
        for line in run.logs
        if isinstance(line, Logged) and line.severity is Severity.ERROR
    ]
    at = lines[0].t if lines else None
    seen = f"{len(lines)} of {BAD_LABELS}"
    return Verdict(len(lines) >= BAD_LABELS, EXPECTED, seen, at)


CHECKS = (
    never_raises(),
    is_called_often("weigh_callback", 9),
    Check("each bad label is logged as an error", _judge_errors),
)


def _failed(run: Timeline) -> Span:
    """The call of weigh_callback that raised."""
    return next(
        span
        for entity in entities_named(run, "weigh_callback")
        for span in run.spans_of(entity, whole_run(run))
        if span.error
    )


def when_spin_raises(run: Timeline) -> int:
    """Whether spin raised at once, with the next callback, or never."""
    ended = run.ended
    if ended is None or not ended.failed:
        return 2
    return 0 if ended.t - _failed(run).start < SECOND // 10 else 1


def parcels_weighed_afterwards(run: Timeline) -> int:
    """Whether scales, belt and all went on, the belt alone, or none."""
    later = run.end - _failed(run).start > 5 * SECOND
    if not later:
        return 2
    return 0 if run.ended is None or not run.ended.failed else 1
