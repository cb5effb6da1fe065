"""What a run of this lesson shows, and what a mended node must do."""

from lessons.checks import (
    SECOND,
    WHOLE_RUN,
    Check,
    Verdict,
    calls_of,
    every_call_answered,
    keeps_coming,
    log_says,
    never_raises,
    replies_within,
    requests_of,
    spans_of,
)
from sim.trace.model import Window
from sim.trace.timeline import Timeline


def _judge_pages(run: Timeline) -> Verdict:
    """Whatever begins to be printed is printed."""
    expected = "a DONE for each page"
    begun = [line for line in run.logs if line.text.endswith("...")]
    done = [line for line in run.logs if line.text.endswith("...DONE")]
    if not begun:
        return Verdict(False, expected, "no page")
    seen = f"{len(done)} of {len(begun)}"
    return Verdict(len(done) == len(begun), expected, seen, begun[-1].t)


def _judge_quiet(run: Timeline) -> Verdict:
    """After the first answer no page begins."""
    expected = "no page after the answer"
    replied = [call.replied for call in requests_of(run, "/switch_off")]
    if not replied or replied[0] is None:
        return Verdict(False, expected, "no answer")
    later = calls_of(
        run, "print_callback", Window(replied[0] + 1, run.end + 1)
    )
    at = later[0].start if later else None
    return Verdict(not later, expected, f"{len(later)} of them", at)


CHECKS = (
    log_says("...DONE"),
    Check("a page that is begun is printed", _judge_pages),
    Check("no page begins once it is switched off", _judge_quiet),
    keeps_coming("lamp_callback", WHOLE_RUN, at_least=1.6),
    every_call_answered(),
    replies_within("/switch_off", 1.5),
    never_raises(),
)


def what_becomes_of_the_page(run: Timeline) -> int:
    """Whether the call ended at once, went on, or was waited for."""
    off = requests_of(run, "/switch_off")[0]
    page = spans_of(run, "print_callback")[0]
    if off.replied is not None and off.replied - off.sent > SECOND // 5:
        return 2
    return 0 if page.end_at(run.end) - off.sent < SECOND // 10 else 1


def what_becomes_of_the_node(run: Timeline) -> int:
    """Whether it goes on, without its message or with it, or ends."""
    if run.ended is not None and run.ended.failed:
        return 2
    return 1 if any("DONE" in line.text for line in run.logs) else 0
