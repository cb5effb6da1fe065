"""What a run of this lesson shows, and what a mended clock must do."""

import re

from lessons.checks import (
    SECOND,
    Check,
    Verdict,
    calls_of,
    is_called_often,
    log_says,
)
from sim.trace.model import Span
from sim.trace.timeline import Timeline

TOLD = re.compile(r"SHIFT LASTS (\d+) s")
EXPECTED = "never more than 1 s off"


def _judge_times(run: Timeline) -> Verdict:
    """Hold the time in each line of the clock against the run's."""
    told = [
        (int(found[1]), line.t)
        for line in run.logs
        if (found := TOLD.search(line.text))
    ]
    if not told:
        return Verdict(False, EXPECTED, "no line that says SHIFT LASTS ... s")
    for seconds, at in told:
        if abs(at - seconds * SECOND) > SECOND:
            return Verdict(False, EXPECTED, f"{seconds} s told", at)
    return Verdict(True, EXPECTED, f"{len(told)} right times")


CHECKS = (
    Check("the clock tells the right time", _judge_times),
    log_says("UNLOADING...DONE", at_least=2),
    is_called_often("timer_callback", 15),
)


def _ticks_from_delivery(run: Timeline) -> list[Span]:
    """The tick that unloads the first lorry, and those after it."""
    ticks = calls_of(run, "timer_callback")
    long = (
        place
        for place, tick in enumerate(ticks)
        if tick.end_at(run.end) - tick.start > 3 * SECOND
    )
    return ticks[next(long) :]


def ticks_that_were_missed(run: Timeline) -> int:
    """Whether all missed ticks came at the end, one of them, or none."""
    long, *later = _ticks_from_delivery(run)
    end = long.end_at(run.end)
    soon = [tick for tick in later if tick.start - end < SECOND // 10]
    return {3: 0, 1: 1}.get(len(soon), 2)


def rhythm_afterwards(run: Timeline) -> int:
    """Whether the ticks go on as before, or from the late one."""
    long, late, following, *_ = _ticks_from_delivery(run)
    if _is_whole(following.start - long.start):
        return 0
    return 1 if _is_whole(following.start - late.start) else 2


def _is_whole(length: int) -> bool:
    """Whether a length is one of whole seconds, but for a machine's jitter."""
    return abs(length - round(length / SECOND) * SECOND) < SECOND // 10
