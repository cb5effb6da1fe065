"""What a run of this lesson shows, and what a mended node must do."""

from lessons.checks import (
    SECOND,
    Check,
    Verdict,
    calls_of,
    is_called_often,
    never_raises,
    seconds,
    spans_of,
)
from sim.trace.model import Window
from sim.trace.timeline import Timeline

SETTLED = 8 * SECOND
"""From then on the queue of the node is full."""
FRESH = SECOND // 4


def _judge_age(run: Timeline) -> Verdict:
    expected = f"at most {seconds(FRESH)} old"
    calls = calls_of(run, "decide")
    if not calls:
        return Verdict(False, expected, "no call of decide")
    oldest = max(calls, key=lambda call: call.age)
    passed = oldest.age <= FRESH
    return Verdict(passed, expected, f"{seconds(oldest.age)}", oldest.start)


def _judge_looking(run: Timeline) -> Verdict:
    expected = "half a second for each picture"
    done = [span for span in spans_of(run, "decide") if span.end is not None]
    if not done:
        return Verdict(False, expected, "no call of decide")
    quickest = min(done, key=lambda span: span.end_at(run.end) - span.start)
    took = quickest.end_at(run.end) - quickest.start
    passed = took >= SECOND // 2
    return Verdict(passed, expected, seconds(took), quickest.start)


CHECKS = (
    Check("the picture is fresh when decide begins", _judge_age),
    Check("decide looks at its picture", _judge_looking),
    is_called_often("decide", 35),
    is_called_often("take_picture", 95),
    never_raises(),
)


def age_after_a_while(run: Timeline) -> int:
    """Whether pictures were fresh, two seconds old, or ever older."""
    calls = calls_of(run, "decide", Window(SETTLED, run.end))
    ages = [call.age for call in calls]
    if max(ages) < SECOND // 2:
        return 0
    if max(ages) < 2.1 * SECOND and max(ages) - min(ages) < SECOND // 2:
        return 1
    return 2


def what_becomes_of_the_others(run: Timeline) -> int:
    """Whether all pictures came to be seen, or some, or most were lost."""
    taken = len(calls_of(run, "take_picture"))
    lost = run.dropped(run.end) / taken
    if not lost:
        return 0
    return 1 if lost < 0.3 else 2
