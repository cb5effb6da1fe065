"""The rule on events that are missing from the trace."""

from collections.abc import Iterator

from sim.diagnosis.rule import Explanation, Finding, Rule, Weight
from sim.diagnosis.timeline_view import TimelineView
from sim.trace.timeline import Timeline


class GapsInTrace(Rule):
    """Events were dropped, so other rules may have missed a start, an end or a reply."""

    id = "gaps-in-trace"
    summary = "events are missing, and other findings may be wrong"
    weight = Weight.REMARK

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield the number of missing events."""
        if view.timeline.lost:
            yield Finding(self, 0, view.end, size=view.timeline.lost)

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        missing = "1 event is" if found.size == 1 else f"{found.size:,} events are"
        return Explanation(
            f"{missing} missing from the trace: what is found about calls, waits and queues may be wrong",
            "the program did more at once than could be sent; a start, an end or a reply may be among them",
            "let the program do less at once, or run it on virtual time, where no event is lost",
            None,
        )
