"""What a run of this lesson shows."""

from lessons.checks import SECOND, spans_of
from sim.trace.model import Window
from sim.trace.timeline import Timeline

LOCK = "count_with_lock"
GROUP = "count_in_group"
PAUSE = 2 * SECOND
"""A longer one between two calls of a station: another lorry came."""


def _at_once(run: Timeline, callback: str) -> int:
    """The most calls of a callback that ran at the same time."""
    spans = spans_of(run, callback)
    return max(
        sum(
            other.start <= span.start < other.end_at(run.end)
            for other in spans
        )
        for span in spans
    )


def _first_lorry(run: Timeline, callback: str) -> Window:
    """From the first call of a station to the end of its first boxes."""
    first, *others = spans_of(run, callback)
    end = first.end_at(run.end)
    for span in others:
        if span.start > end + PAUSE:
            break
        end = max(end, span.end_at(run.end))
    return Window(first.start, end)


def busy_at_the_lock(run: Timeline) -> int:
    """Whether one worker, two or all four were in the callback at once."""
    most = _at_once(run, LOCK)
    if most == 1:
        return 0
    return 2 if most == 4 else 1


def who_is_done_first(run: Timeline) -> int:
    """Whether the lock's boxes are done sooner, the group's, or neither."""
    lock = _first_lorry(run, LOCK).length
    group = _first_lorry(run, GROUP).length
    if abs(lock - group) < SECOND // 4:
        return 2
    return 0 if lock < group else 1
