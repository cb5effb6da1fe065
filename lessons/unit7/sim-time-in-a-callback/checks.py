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
EXPECTED = "1.8 to 2.5 s from DOUGH IN to BREAD OUT"


def _told(run: Timeline, text: str) -> list[int]:
    """When lines with a text were logged."""
    return [line.t for line in run.logs if text in line.text]


def _bakes_for_two_seconds(run: Timeline) -> Verdict:
    dough, bread = _told(run, "DOUGH IN"), _told(run, "BREAD OUT")
    if not dough or not bread:
        missing = "BREAD OUT" if dough else "DOUGH IN"
        return Verdict(
            False, EXPECTED, f"no {missing}", dough[0] if dough else None
        )
    for begun, ended in zip(dough, bread, strict=False):
        if not 1.8 * SECOND <= ended - begun <= 2.5 * SECOND:
            return Verdict(False, EXPECTED, seconds(ended - begun), begun)
    return Verdict(True, EXPECTED, seconds(bread[0] - dough[0]), dough[0])


CHECKS = (
    log_says("BREAD OUT", at_least=2),
    Check("bread takes two seconds", _bakes_for_two_seconds),
    keeps_coming("lamp_callback", NODE_RUNS, at_least=1.6),
    every_call_answered(),
    never_raises(),
)


def when_the_bread_is_out(run: Timeline) -> int:
    """Whether it is out in time, later, or never."""
    dough, bread = _told(run, "DOUGH IN"), _told(run, "BREAD OUT")
    if not bread:
        return 2
    return 0 if bread[0] - dough[0] <= 2 * SECOND else 1


def lamp_while_it_bakes(run: Timeline) -> int:
    """Whether the lamp blinks on, comes back after a while, or never."""
    asked = requests_of(run, "/bake")[0].sent
    baking = Window(asked + SECOND // 10, asked + 2 * SECOND)
    if calls_of(run, "lamp_callback", baking):
        return 0
    later = Window(baking.end, run.end + 1)
    return 1 if calls_of(run, "lamp_callback", later) else 2
