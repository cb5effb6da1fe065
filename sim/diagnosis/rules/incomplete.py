"""Why findings may be incomplete: rules that fail themselves, and events that are missing from the trace."""

from collections.abc import Iterator

from sim.diagnosis.rule import REPORT_IT, Explanation, Finding, Rule, Weight
from sim.diagnosis.timeline_view import TimelineView
from sim.trace.timeline import Timeline


class FailedRules(Rule):
    """Rules that could not look at the run. Finds nothing itself: whoever calls the rules tells of them."""

    id = "failed-rule"
    summary = "rules that could not look at the run"
    weight = Weight.REMARK

    def check(self, view: TimelineView) -> Iterator[Finding]:
        return iter(())

    def failed(self, rule: Rule, fault: str, timeline: Timeline) -> Finding:
        """Return the finding of a rule that failed, with what it failed with."""
        return Finding(self, timeline.end, timeline.end, about=rule.summary, detail=fault)

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        return Explanation(f"cbtui could not check this: {found.about}", found.detail, REPORT_IT, None)


FAILED_RULES = FailedRules()
"""The one that all share."""


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
