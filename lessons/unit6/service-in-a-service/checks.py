"""What a run of this lesson shows, and what a mended node must do."""

from lessons.checks import (
    SECOND,
    calls_of,
    every_call_answered,
    is_called_often,
    log_says,
    never_raises,
    never_stuck,
    replies_within,
)
from sim.trace.model import Window
from sim.trace.timeline import Timeline

OUTER = "/pack"
INNER = "/weigh"

CHECKS = (
    never_stuck(),
    never_raises(),
    every_call_answered(),
    replies_within(OUTER, 1.0),
    replies_within(INNER, 0.5),
    log_says("PACKED 2 KG", at_least=3),
    is_called_often("belt", at_least=12),
)


def weigh_while_pack_waits(run: Timeline) -> int:
    """Whether weigh ran, never began, or pack raised an error."""
    pack = calls_of(run, OUTER)[0]
    if pack.error:
        return 2
    return 0 if calls_of(run, INNER) else 1


def belt_after_the_call(run: Timeline) -> int:
    """Whether the belt moved on, stood for a while, or stood for ever."""
    pack = calls_of(run, OUTER)[0]
    # A beat of the very moment at which pack begins came before it.
    beats = calls_of(run, "belt", Window(pack.start + 1, run.end))
    if not beats:
        return 2
    return 0 if beats[0].age < SECOND // 4 else 1
