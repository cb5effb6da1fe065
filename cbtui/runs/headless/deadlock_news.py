"""Tells of deadlocks while a run goes on, which may take long to end."""

from cbtui.runs.live.findings import ExplainedFinding, FindingsMonitor
from sim.quantities.nanoseconds import SECOND
from sim.trace.timeline import Timeline


class DeadlockNews:
    """Looks for deadlocks in a growing timeline at most once a second of the run, and tells each once."""

    def __init__(self, timeline: Timeline) -> None:
        self._timeline = timeline
        self._monitor = FindingsMonitor(timeline)
        self._next_look = SECOND
        self._told: set[object] = set()

    def news(self) -> list[str]:
        """Return a sentence on each new deadlock: who waits for what, and the line."""
        if self._timeline.end < self._next_look:
            return []
        self._next_look = self._timeline.end + SECOND
        self._monitor.update_when_due()
        new = [each for each in self._monitor.findings if _is_deadlock(each)]
        new = [each for each in new if each.finding.key not in self._told]
        self._told.update(each.finding.key for each in new)
        return [told_in_a_line(each) for each in new]


def _is_deadlock(found: ExplainedFinding) -> bool:
    return found.explanation.for_ever and bool(found.finding.ring)


def told_in_a_line(found: ExplainedFinding) -> str:
    """What a finding says, and its place if that is not part of it: ``…, node.py:17``."""
    what, place = found.explanation.what, found.explanation.place
    return what if place is None or str(place) in what else f"{what}, {place}"
