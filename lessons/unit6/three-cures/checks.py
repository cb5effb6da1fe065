"""What a run of this lesson shows."""

from lessons.checks import SECOND, calls_of, spans_of
from sim.trace.timeline import Timeline

LEAVE = "ask_and_leave"
AWAIT = "ask_and_await"
WAIT = "ask_and_wait"


def who_keeps_a_thread(run: Timeline) -> int:
    """Whether one, two or all ways, or none, hold a thread for a second."""
    keep = {
        name for name in (LEAVE, AWAIT, WAIT) if longest(run, name) > SECOND
    }
    answers = [{LEAVE, AWAIT, WAIT}, {AWAIT, WAIT}, {WAIT}, set()]
    return answers.index(keep)


def who_is_called_every_second(run: Timeline) -> int:
    """Whether all ways, two of them, or one were called on every tick."""
    ticks = run.end // SECOND - 1
    often = {
        name
        for name in (LEAVE, AWAIT, WAIT)
        if len(calls_of(run, name)) >= ticks
    }
    answers = [{LEAVE, AWAIT, WAIT}, {LEAVE, AWAIT}, {LEAVE}]
    return answers.index(often)


def longest(run: Timeline, callback: str) -> int:
    """Nanoseconds for which a callback held a thread at the most."""
    spans = spans_of(run, callback)
    return max(span.end_at(run.end) - span.start for span in spans)
