"""Tells of deadlocks while a run goes on, which may take long to end."""

from collections.abc import Sequence

from cbtui.runs.live.findings import ExplainedFinding, FindingsMonitor
from sim.quantities.nanoseconds import SECOND
from sim.trace.events import AnyEvent, EntityId, Notice, NoticeKind
from sim.trace.timeline import Timeline


class DeadlockNews:
    """Looks for deadlocks in a growing timeline at most once a second of the run, and tells each once."""

    def __init__(self, timeline: Timeline) -> None:
        self._timeline = timeline
        self._monitor = FindingsMonitor(timeline)
        self._next_look = SECOND
        self._told: set[object] = set()
        self._stuck: set[EntityId] = set()

    def news(self, events: Sequence[AnyEvent] = ()) -> list[str]:
        """Return a sentence on each new deadlock: who waits for what, and the line.

        Where the latest events tell that a callback does not go on, it looks at once.
        """
        if self._timeline.end < self._next_look and not any(map(_tells_of_hanging, events)):
            return []
        self._next_look = self._timeline.end + SECOND
        self._monitor.update_when_due()
        new = [each for each in self._monitor.findings if _is_deadlock(each)]
        new = [each for each in new if each.finding.key not in self._told]
        self._told.update(each.finding.key for each in new)
        self._stuck.update(*(each.finding.stuck for each in new))
        return [told_in_a_line(each) for each in new]

    def without_told(self, events: list[AnyEvent]) -> list[AnyEvent]:
        """Return events without the notices that callbacks do not go on of which a deadlock is told."""
        return [
            each
            for each in events
            if not (isinstance(each, Notice) and _tells_of_hanging(each) and each.entity in self._stuck)
        ]


def _tells_of_hanging(event: AnyEvent) -> bool:
    return isinstance(event, Notice) and event.kind is NoticeKind.NO_PROGRESS


def _is_deadlock(found: ExplainedFinding) -> bool:
    return found.explanation.for_ever and bool(found.finding.ring)


def told_in_a_line(found: ExplainedFinding) -> str:
    """What a finding says, and its place if that is not part of it: ``…, node.py:17``."""
    what, place = found.explanation.what, found.explanation.place
    return what if place is None or str(place) in what else f"{what}, {place}"
