"""The rule on callbacks that wait for a lock that is not released or an event that is not set."""

from collections.abc import Iterator

from sim.diagnosis.rule import Explanation, Finding, Rule, Weight, place_of
from sim.diagnosis.timeline_view import TimelineView
from sim.diagnosis.words import often, who
from sim.trace.events import Notice, NoticeKind, Severity
from sim.trace.model import Window
from sim.trace.timeline import Timeline

_ADVICE = "wait with a timeout, and see that something ends the wait"
"""For recordings whose notices have no advice."""


class EndlessWait(Rule):
    """A callback waits without a timeout, and what it waits for does not come.

    The engine reports it on virtual time, where it sees what all threads of a program wait for. A deadlock is
    final; any other wait is reported until the callback returns.
    """

    id = "endless-wait"
    summary = "a callback waits for a lock or an event that does not come"

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each wait that the engine reported."""
        for notice in view.timeline.notices:
            if notice.entity:
                until = _until(notice, view)
                yield Finding(self, notice.t, until, notice.entity, detail=notice.text)

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        """Repeat the engine's notice."""
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
        """Irrelevant if the wait ended after all."""
        over = found.until < timeline.end and not _is_deadlock(_notice_of(found, timeline))
        return None if over else Weight.PROBLEM


def _notice_of(found: Finding, timeline: Timeline) -> Notice:
    return next(each for each in timeline.notices if each.t == found.at and each.text == found.detail)


def _is_deadlock(notice: Notice) -> bool:
    """Whether the notice reports a deadlock; in recordings without kinds only these are errors."""
    return notice.kind is NoticeKind.DEADLOCK or notice.severity is Severity.ERROR


def _until(notice: Notice, view: TimelineView) -> int:
    """The end of the call that a notice is about; now if it lasts."""
    spans = view.timeline.spans_of(notice.entity, Window(notice.t, notice.t + 1))
    return max((view.end if span.end is None else span.end for span in spans), default=view.end)
