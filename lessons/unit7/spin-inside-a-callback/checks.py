"""What a run of this lesson shows, and what a mended node must do."""

from lessons.checks import (
    SECOND,
    calls_of,
    is_called_often,
    log_says,
    never_raises,
    never_stuck,
    never_waits_longer_than,
    runs_long,
)
from sim.trace.model import Window
from sim.trace.timeline import Timeline

CHECKS = (
    never_waits_longer_than("blink_callback", 0.5),
    is_called_often("blink_callback", 25),
    is_called_often("ask_callback", 4),
    log_says("GOT PART", at_least=4),
    never_raises(),
    never_stuck(),
)


def blink_while_it_spins(run: Timeline) -> int:
    """Whether blink waited, ran elsewhere, or ran in the asking thread."""
    asked = calls_of(run, "ask_callback")[0]
    meanwhile = Window(asked.start + 1, asked.end_at(run.end))
    blinks = calls_of(run, "blink_callback", meanwhile)
    threads = {each.thread for each in blinks}
    if not threads:
        return 0
    return 2 if threads == {asked.thread} else 1


def asker_after_the_answer(run: Timeline) -> int:
    """Whether the asker went on, only blinked, or did nothing more."""
    answered = runs_long("ask_callback", 0.5).windows(run)[0].end
    later = Window(answered + SECOND // 10, run.end + 1)
    if calls_of(run, "ask_callback", later):
        return 0
    return 1 if calls_of(run, "blink_callback", later) else 2
