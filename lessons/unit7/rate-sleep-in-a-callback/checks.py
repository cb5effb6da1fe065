"""What a run of this lesson shows, and what a mended node must do."""

from lessons.checks import (
    SECOND,
    Check,
    Stretch,
    Verdict,
    calls_of,
    every_call_answered,
    keeps_coming,
    log_says,
    never_raises,
    seconds,
    whole_run,
)
from sim.trace.model import Window
from sim.trace.timeline import Timeline

NODE_RUNS = Stretch("the node runs", lambda run: [whole_run(run)])
EXPECTED = "from STEP 1 to STEP 4 in 1.4 to 2.6 s"


def _walks_at_its_pace(run: Timeline) -> Verdict:
    first = next((line.t for line in run.logs if "STEP 1" in line.text), None)
    last = next((line.t for line in run.logs if "STEP 4" in line.text), None)
    if first is None or last is None:
        missing = "STEP 1" if first is None else "STEP 4"
        return Verdict(False, EXPECTED, f"no {missing}", first)
    took = last - first
    right = 1.4 * SECOND <= took <= 2.6 * SECOND
    return Verdict(right, EXPECTED, seconds(took), first)


CHECKS = (
    keeps_coming("blink_callback", NODE_RUNS, at_least=1.75),
    log_says("ROUND DONE", at_least=2),
    Check("the watchman keeps his pace", _walks_at_its_pace),
    every_call_answered(),
    never_raises(),
)


def second_step(run: Timeline) -> int:
    """Whether the second step came in time, late, or not at all."""
    steps = [line.t for line in run.logs if "STEP 2" in line.text]
    if not steps:
        return 2
    return 0 if steps[0] - _begun(run) < SECOND else 1


def blink_in_the_round(run: Timeline) -> int:
    """Whether blink went on, came back after a while, or never did."""
    begun = _begun(run)
    round_time = Window(begun + 1, begun + 2 * SECOND)
    if calls_of(run, "blink_callback", round_time):
        return 0
    later = Window(round_time.end, run.end + 1)
    return 1 if calls_of(run, "blink_callback", later) else 2


def _begun(run: Timeline) -> int:
    """When the first round began: a blink may come before it."""
    return calls_of(run, "walk_callback")[0].start
