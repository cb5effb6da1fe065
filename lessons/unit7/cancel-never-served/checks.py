"""What a run of this lesson shows, and what a mended node must do."""

from lessons.checks import (
    SECOND,
    Check,
    Verdict,
    every_call_answered,
    log_never_says,
    log_says,
    never_raises,
    seconds,
)
from sim.trace.timeline import Timeline

MOST_STEPS = 3


def _told(run: Timeline, text: str) -> list[int]:
    """When lines with a text were logged."""
    return [line.t for line in run.logs if text in line.text]


def _judge_steps(run: Timeline) -> Verdict:
    """Each goal begins with a STEP 1; none may come to a fourth step."""
    expected = f"at most {MOST_STEPS} steps of a goal"
    too_far = _told(run, f"STEP {MOST_STEPS + 1}")
    if not _told(run, "STEP 1"):
        return Verdict(False, expected, "none")
    seen = "more of them" if too_far else "no more"
    return Verdict(
        not too_far, expected, seen, too_far[0] if too_far else None
    )


def _judge_pace(run: Timeline) -> Verdict:
    """The robot takes its time for a step."""
    expected = "1 s from STEP 1 to STEP 2"
    first, second = _told(run, "STEP 1"), _told(run, "STEP 2")
    if not first or not second:
        return Verdict(False, expected, "no second step")
    took = second[0] - first[0]
    return Verdict(
        0.9 * SECOND <= took <= 1.4 * SECOND, expected, seconds(took), first[0]
    )


CHECKS = (
    log_says("RESULT canceled", at_least=2),
    log_never_says("RESULT succeeded"),
    Check("a cancelled goal ends soon", _judge_steps),
    Check("a step takes its time", _judge_pace),
    log_says("CALLED BACK", at_least=2),
    every_call_answered(),
    never_raises(),
)


def how_the_goal_ends(run: Timeline) -> int:
    """Whether it stops early, is cancelled after all steps, or succeeds."""
    if _told(run, "RESULT succeeded"):
        return 2
    return 1 if _told(run, "STEP 5") else 0


def when_the_cancel_is_answered(run: Timeline) -> int:
    """Whether the answer comes soon, after the goal, or never."""
    asked, answered = (
        _told(run, "CALLED BACK"),
        _told(run, "CANCEL refused") + _told(run, "CANCEL accepted"),
    )
    if not answered:
        return 2
    return 0 if min(answered) - asked[0] < SECOND // 2 else 1
