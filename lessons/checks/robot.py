"""Checks on the robot's turns, and on the age of the data on which a callback decides."""

from collections.abc import Iterator

from lessons.checks.check import Check, Verdict
from lessons.checks.reading import calls_of, rotations, seconds, spans_of
from sim.quantities.nanoseconds import nearest_ns
from sim.quantities.plural import counted
from sim.trace.model import Nanoseconds, Span
from sim.trace.timeline import Timeline


def turns(times: int) -> Check:
    """The robot makes a number of turns; a turn lasts from a command to turn to the first other command."""
    expected = counted(times, "turn")

    def judge(run: Timeline) -> Verdict:
        found = rotations(run)
        at = found[min(times, len(found) - 1)].start if found else None
        return Verdict(len(found) == times, expected, counted(len(found), "turn"), at)

    return Check(f"the robot makes {expected}", judge)


def data_never_older(subscription: str, timer: str, limit: float) -> Check:
    """When a timer's callback begins, the message that a subscription took last is at most ``limit`` s old.

    Calls before the first message do not count.
    """
    most = nearest_ns(limit)
    expected = f"at most {seconds(most)} old"

    def judge(run: Timeline) -> Verdict:
        ages = list(_ages(spans_of(run, subscription), calls_of(run, timer)))
        if not ages:
            return Verdict(False, expected, f"no call of {timer} after a message of {subscription}")
        age, at = max(ages)
        return Verdict(age <= most, expected, f"{seconds(age, limit)} old", at)

    return Check(f"{subscription} data is fresh when {timer} decides", judge)


def _ages(taken: list[Span], decisions: list[Span]) -> Iterator[tuple[Nanoseconds, Nanoseconds]]:
    """Return the age of the newest message at each decision that had one, and the decision's time."""
    done = sorted((span.end, span.start - span.age) for span in taken if span.end is not None)
    newest: Nanoseconds | None = None
    for decision in decisions:
        while done and done[0][0] <= decision.start:
            published = done.pop(0)[1]
            newest = published if newest is None else max(newest, published)
        if newest is not None:
            yield decision.start - newest, decision.start
