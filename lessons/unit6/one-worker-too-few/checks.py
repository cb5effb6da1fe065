"""What a run of this lesson shows, and what a mended node must do."""

from lessons.checks import (
    SECOND,
    calls_of,
    every_call_answered,
    is_called_often,
    never_stuck,
    overlap,
    replies_within,
    requests_of,
)
from sim.trace.model import Window
from sim.trace.timeline import Timeline

SERVICE = "/clamp"

CHECKS = (
    never_stuck(),
    every_call_answered(),
    replies_within(SERVICE, 1.0),
    is_called_often("left", at_least=15),
    is_called_often("right", at_least=10),
    is_called_often("middle", at_least=8),
    overlap("left", "middle"),
)


def first_call_without_a_reply(run: Timeline) -> int:
    """Whether the first call hung, all were answered, or two at once hung."""
    calls = requests_of(run, SERVICE)
    hung = [call for call in calls if call.replied is None]
    if not hung:
        return 1
    if hung[0] is calls[0]:
        return 0
    together = len(hung) > 1 and hung[1].sent - hung[0].sent < SECOND // 10
    return 2 if together else 1


def clamp_after_it_hangs(run: Timeline) -> int:
    """Whether the clamp worked and replied in vain, or never began."""
    hung = [each for each in requests_of(run, SERVICE) if each.replied is None]
    after = Window(hung[0].sent, run.end)
    moved = calls_of(run, SERVICE, after)
    if not moved:
        return 2
    return 0 if moved[0].start - hung[0].sent < SECOND // 10 else 1
