"""What a run of this lesson shows, and what a mended node must do."""

from lessons.checks import calls_of, keeps_coming, runs_long
from sim.trace.timeline import Timeline

CHECKS = (keeps_coming("blink", runs_long("work"), at_least=1.5),)


def blink_while_work_sleeps(run: Timeline) -> int:
    """Whether blink went on or waited."""
    sleeps = runs_long("work").windows(run)[0]
    return 0 if len(calls_of(run, "blink", sleeps)) > 1 else 1
