"""What a run of this lesson shows, and what a mended node must do."""

from lessons.checks import (
    SECOND,
    calls_of,
    is_called,
    keeps_coming,
    log_says,
    never_overlap,
    never_raises,
    never_stuck,
    spans_of,
)
from sim.trace.model import Window
from sim.trace.timeline import Timeline

PRINTER = "/print_label"
PRINTS = is_called(PRINTER)

CHECKS = (
    keeps_coming("watch_callback", PRINTS, at_least=3),
    log_says("PACKED with LABEL", at_least=3),
    never_overlap("watch_callback"),
    never_raises(),
    never_stuck(),
)


def threads_during_the_print(run: Timeline) -> int:
    """Whether the packer kept a thread while it awaited its label."""
    first = PRINTS.windows(run)[0]
    middle = (first.start + first.end) // 2
    busy = (
        span.start <= middle < span.end_at(run.end)
        for span in spans_of(run, "pack_callback")
    )
    return 0 if any(busy) else 1


def watch_during_the_print(run: Timeline) -> int:
    """Whether the belt was watched during a print, after it, or late."""
    first = PRINTS.windows(run)[0]
    meanwhile = Window(first.start + 1, first.end)
    if calls_of(run, "watch_callback", meanwhile):
        return 0
    soon = Window(first.end, first.end + SECOND // 20)
    return 2 if len(calls_of(run, "watch_callback", soon)) > 1 else 1
