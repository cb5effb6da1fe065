"""The rule on execute callbacks that do not ask whether their goal is cancelled."""

from collections.abc import Iterator

from sim.diagnosis.edits.cancelling import end_if_cancelled
from sim.diagnosis.rule import Explanation, Finding, Rule, by_edit, line_of
from sim.diagnosis.timeline_view import TimelineView
from sim.diagnosis.words import often, who
from sim.quantities.durations import duration
from sim.quantities.nanoseconds import SECOND
from sim.trace.events import NoticeKind
from sim.trace.model import Window
from sim.trace.timeline import Timeline

_LATE = 2 * SECOND
"""How long after the accepted cancel the engine tells of it."""


class CancelIgnored(Rule):
    """An execute callback goes on after the cancel of its goal was accepted, and does not look at that.

    Source: rclpy's ``ServerGoalHandle``, which ``canceled()`` and the like end, and nothing else.
    """

    id = "cancel-ignored"
    summary = "an action's execute callback does not look whether its goal is cancelled"

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each goal that the engine reports; of several at once, until the first one ends."""
        for notice in view.timeline.notices:
            if notice.kind is NoticeKind.CANCEL_IGNORED:
                spans = view.timeline.spans_of(notice.entity, Window(notice.t, notice.t + 1))
                until = min((span.end_at(view.end) for span in spans), default=view.end)
                yield Finding(self, notice.t - _LATE, until, notice.entity)

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        subject = who(found.subject, timeline)
        place = line_of(found.subject, Window(found.at, found.until), timeline)
        made = timeline.entities[found.subject].made_at
        how = "has gone on" if found.until >= timeline.end else "went on"
        return Explanation(
            f"{subject} {how} for {duration(found.lasted)} after the cancel of its goal was accepted, "
            f"without a look at is_cancel_requested in the first {duration(_LATE)}{often(found.count)}",
            "an accepted cancel stops nothing by itself: it only sets is_cancel_requested, and the goal ends "
            "as the callback says",
            f"look at is_cancel_requested in each round of {subject}; if it is set, call canceled() and "
            "return a result",
            place,
            remedies=by_edit(place, "end the goal in its loop once it is cancelled", end_if_cancelled, made),
        )
