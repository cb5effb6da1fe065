"""The rule on callbacks that wait for a lock, an event or the like that nobody lets go of or sets."""

from collections.abc import Iterator

from sim.diagnosis.rule import Explanation, Finding, Rule, Weight, place_of
from sim.diagnosis.timeline_view import TimelineView
from sim.diagnosis.words import often, who
from sim.trace.events import Notice, NoticeKind, Severity
from sim.trace.model import Window
from sim.trace.timeline import Timeline

_ADVICE = "wait with a timeout, and see that something ends the wait"
"""For recordings whose notices have none."""


class EndlessWait(Rule):
    """A callback waits without a timeout, and what it waits for does not come.

    The engine tells of it on virtual time, where it sees what all threads of a program wait for. Where it is
    a deadlock, that is sure; else it is told of as long as the callback has not come back.
    """

    id = "endless-wait"
    summary = "a callback waits for a lock or an event that does not come"

    def check(self, look: TimelineView) -> Iterator[Finding]:
        """Yield each wait that the engine tells of."""
        for notice in look.timeline.notices:
            if notice.entity:
                until = _until(notice, look)
                yield Finding(self, notice.t, until, notice.entity, detail=notice.text)

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        """Say it as the engine does."""
        notice = _notice_of(found, timeline)
        how = "is in a deadlock" if _is_deadlock(notice) else "stands still"
        what = f" {how}: {notice.problem}" if notice.problem else f": {notice.text}"
        return Explanation(
            f"{who(found.subject, timeline)}{what}{often(found.count)}",
            "a thread that waits serves nothing else, and without a timeout it may do so for ever",
            notice.advice or _ADVICE,
            place_of(found.subject, timeline),
        )

    def weigh(self, found: Finding, timeline: Timeline) -> Weight | None:
        """Nothing, if it came to an end after all."""
        over = found.until < timeline.end and not _is_deadlock(_notice_of(found, timeline))
        return None if over else Weight.PROBLEM


def _notice_of(found: Finding, timeline: Timeline) -> Notice:
    return next(each for each in timeline.notices if each.t == found.at and each.text == found.detail)


def _is_deadlock(notice: Notice) -> bool:
    """Whether it is sure; recordings without kinds tell of deadlocks, and of nothing else, as errors."""
    return notice.kind is NoticeKind.DEADLOCK or notice.severity is Severity.ERROR


def _until(notice: Notice, look: TimelineView) -> int:
    """When the call ended that a notice is about, or until now."""
    spans = look.timeline.spans_of(notice.entity, Window(notice.t, notice.t + 1))
    return max((look.end if span.end is None else span.end for span in spans), default=look.end)
