"""What a run of this lesson shows, and what a mended node must do."""

from lessons.checks import (
    SECOND,
    Check,
    Verdict,
    log_says,
    never_raises,
    seconds,
)
from sim.trace.timeline import Timeline


def _told(run: Timeline, text: str) -> list[int]:
    """When lines with a text were logged."""
    return [line.t for line in run.logs if text in line.text]


def _judge_valve(run: Timeline) -> Verdict:
    expected = "VALVE CLOSED at most 3.5 s after VALVE OPEN"
    opened, closed = _told(run, "VALVE OPEN"), _told(run, "VALVE CLOSED")
    if not opened or not closed:
        return Verdict(False, expected, "never", opened[0] if opened else None)
    took = closed[0] - opened[0]
    return Verdict(took <= 3.5 * SECOND, expected, seconds(took), closed[0])


def _judge_end(run: Timeline) -> Verdict:
    """Ctrl-C still ends the program, if not at once."""
    expected = "the program ends at most 3 s after CTRL-C"
    pressed = _told(run, "CTRL-C")
    if not pressed:
        return Verdict(False, expected, "no CTRL-C")
    ended = run.ended
    if ended is None or ended.time_was_up:
        return Verdict(False, expected, "it goes on", pressed[0])
    took = ended.t - pressed[0]
    return Verdict(took <= 3 * SECOND, expected, seconds(took), pressed[0])


CHECKS = (
    log_says("CTRL-C"),
    Check("the valve is closed", _judge_valve),
    Check("Ctrl-C ends the program", _judge_end),
    never_raises(),
)


def when_the_sleep_ends(run: Timeline) -> int:
    """Whether Ctrl-C ends the sleep, or it lasts, or nobody wakes up."""
    opened, full = _told(run, "VALVE OPEN"), _told(run, "FULL")
    if not full:
        return 0
    return 1 if full[0] - opened[0] > 2.5 * SECOND else 0


def what_becomes_of_the_valve(run: Timeline) -> int:
    """Whether it is closed, or publishing fails unseen, or seen."""
    if _told(run, "VALVE CLOSED"):
        return 0
    return 2 if run.ended is not None and run.ended.failed else 1
