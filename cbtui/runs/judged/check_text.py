"""Results of checks as plain text for a terminal."""

from collections.abc import Iterator
from textwrap import fill

from cbtui.runs.judged.checking import CheckedFile
from lessons.checks import problems
from lessons.judge import JudgedCheck
from sim.diagnosis.text import WIDTH
from sim.quantities.durations import timestamp
from sim.trace.timeline import Timeline

PASSED, FAILED = "✓", "✗"


def checked_text(checked: CheckedFile) -> str:
    """Each check with what it expected and saw, the number that passed, and the faults of a failed run.

    Empty if nothing could be judged.
    """
    if not checked.judged:
        return ""
    return "\n".join([*_lines(checked), ""])


def verdict_line(judged: JudgedCheck) -> str:
    """What a check expected, what it saw, and when."""
    verdict = judged.verdict
    when = "" if verdict.at is None else f", at {timestamp(verdict.at)}"
    return f"expected {verdict.expected}; saw {verdict.seen}{when}"


def _lines(checked: CheckedFile) -> Iterator[str]:
    for each in checked.judged:
        yield f"{PASSED if each.verdict.passed else FAILED} {each.check.asks}"
        yield f"    {verdict_line(each)}"
    yield f"{checked.passed} of {checked.total} checks passed"
    if checked.good:
        return
    for fault in faults(checked.run.timeline):
        yield fill(fault, WIDTH, initial_indent="  ! ", subsequent_indent="    ", break_on_hyphens=False)


def faults(timeline: Timeline) -> Iterator[str]:
    """Yield faults of a run beyond its checks: an early end, and diagnosed problems."""
    ended = timeline.ended
    if ended is not None and not ended.time_was_up:
        yield f"the run was over at {timestamp(ended.t)}: {' '.join(ended.reason.split())}"
    for found in problems(timeline):
        yield found.explained(timeline).what
