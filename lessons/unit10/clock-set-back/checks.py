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
    requests_of,
    seconds,
    whole_run,
)
from sim.trace.model import Window
from sim.trace.timeline import Timeline

NODE_RUNS = Stretch("the node runs", lambda run: [whole_run(run)])


def _told(run: Timeline, text: str) -> list[int]:
    """When lines with a text were logged."""
    return [line.t for line in run.logs if text in line.text]


def _bakings(run: Timeline) -> list[tuple[int, int]]:
    """When dough went in, and how long it was in, or has been so far."""
    out = [*_told(run, "BREAD OUT"), run.end]
    return [
        (t, min(each for each in out if each >= t) - t)
        for t in _told(run, "DOUGH IN")
    ]


def _judge_baking(run: Timeline) -> Verdict:
    expected = "2.8 to 3.4 s from DOUGH IN to BREAD OUT"
    out = _told(run, "BREAD OUT")
    if not out:
        return Verdict(False, expected, "no bread")
    for at, baked in _bakings(run):
        is_last = at + baked == run.end
        if baked > 3.4 * SECOND or (baked < 2.8 * SECOND and not is_last):
            return Verdict(False, expected, seconds(baked), at)
    return Verdict(True, expected, f"{len(out)} loaves in time")


CHECKS = (
    log_says("BREAD OUT", at_least=5),
    Check("each loaf bakes for three seconds", _judge_baking),
    keeps_coming("lamp_callback", NODE_RUNS, at_least=1.6),
    every_call_answered(),
    never_raises(),
)


def when_the_bread_is_out(run: Timeline) -> int:
    """How long the loaf that is in at the jump bakes, all in all."""
    jump = requests_of(run, "/reset")[0].sent
    inside = [baked for at, baked in _bakings(run) if at < jump]
    if inside[-1] < 3.4 * SECOND:
        return 0
    return 1 if max(_told(run, "BREAD OUT")) > jump else 2


def lamp_after_the_jump(run: Timeline) -> int:
    """Whether it blinks on, only at the old time, or for all it missed."""
    jump = requests_of(run, "/reset")[0].sent
    soon = Window(jump + SECOND // 10, jump + SECOND)
    blinks = len(calls_of(run, "lamp_callback", soon))
    return 0 if not blinks else 1 if blinks <= 2 else 2
