"""What a run of this lesson shows, and what a mended file must do."""

from lessons.checks import (
    Check,
    Verdict,
    calls_of,
    every_call_answered,
    is_called_often,
    keeps_coming,
    never_raises,
    runs_long,
    ticks_on_time,
)
from sim.trace.timeline import Timeline

INSPECTS = runs_long("inspect_callback")


def _threads_of(run: Timeline, callback: str) -> set[str]:
    return {run.threads[span.thread].name for span in calls_of(run, callback)}


def _judge_threads(run: Timeline) -> Verdict:
    """Each callback has a thread that the other one never runs on."""
    expected = "a thread for each callback"
    belt = _threads_of(run, "belt_callback")
    camera = _threads_of(run, "inspect_callback")
    if not belt or not camera:
        return Verdict(False, expected, "one that is never called")
    both = ", ".join(sorted(belt & camera))
    return Verdict(
        not both, expected, f"both on {both}" if both else "one for each"
    )


CHECKS = (
    every_call_answered(),
    keeps_coming("belt_callback", INSPECTS, at_least=1.6),
    ticks_on_time("belt_callback", 0.1),
    is_called_often("belt_callback", 18),
    Check("each callback has a thread of its own", _judge_threads),
    never_raises(),
)


def who_runs_the_callbacks(run: Timeline) -> int:
    """Whether both executors' threads run them, the first, or the last."""
    threads = _threads_of(run, "belt_callback") | _threads_of(
        run, "inspect_callback"
    )
    if len(threads) > 1:
        return 0
    return 2 if threads == {"MainThread"} else 1


def belt_during_inspection(run: Timeline) -> int:
    """Whether the belt went on, or stood still."""
    inspection = INSPECTS.windows(run)[0]
    return 0 if calls_of(run, "belt_callback", inspection) else 1
