"""What is told of rules that fail themselves, so that a fault in one leaves the others."""

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
