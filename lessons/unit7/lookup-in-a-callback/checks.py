"""What a run of this lesson shows, and what a mended node must do."""

from lessons.checks import (
    SECOND,
    Stretch,
    calls_of,
    every_call_answered,
    keeps_coming,
    log_says,
    never_raises,
    replies_within,
    requests_of,
    whole_run,
)
from sim.trace.model import Window
from sim.trace.timeline import Timeline

NODE_RUNS = Stretch("the node runs", lambda run: [whole_run(run)])

CHECKS = (
    log_says("LOWERED AT", at_least=3),
    replies_within("/lower", 0.4),
    keeps_coming("swing_callback", NODE_RUNS, at_least=9.5),
    every_call_answered(),
    never_raises(),
)


def what_the_lookup_gets(run: Timeline) -> int:
    """Whether a transform comes soon, late, or an error in its place."""
    asked = requests_of(run, "/lower")[0].sent
    lowered = [line.t for line in run.logs if "LOWERED AT" in line.text]
    if not lowered:
        return 2
    return 0 if lowered[0] - asked < SECOND // 2 else 1


def hook_during_a_lookup(run: Timeline) -> int:
    """Whether the hook swings on, stops for a second, or for good."""
    asked = requests_of(run, "/lower")[0].sent
    waiting = Window(asked + SECOND // 10, asked + SECOND * 9 // 10)
    if calls_of(run, "swing_callback", waiting):
        return 0
    return (
        1
        if calls_of(run, "swing_callback", Window(waiting.end, run.end + 1))
        else 2
    )
