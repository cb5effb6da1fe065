"""The rule on callbacks that make one entity after another and keep them all."""

from collections.abc import Iterator

from sim.diagnosis.rule import Explanation, Finding, Rule, is_models, line_location
from sim.diagnosis.timeline_view import TimelineView
from sim.diagnosis.words import who
from sim.trace.events import EntityId, EntityKind
from sim.trace.model import Window
from sim.trace.timeline import Timeline

_WHY = {
    EntityKind.TIMER: "each of them goes on being called: they take more and more of the thread's time",
    EntityKind.SUBSCRIPTION: "each of them hears every message: it is handled once more with each",
    EntityKind.CLIENT: "each of them stays, and the executor looks at all of them again and again",
    EntityKind.SERVICE: "each of them stays and answers: a request is handled once more with each",
}


class NeverDestroyed(Rule):
    """Several calls of a callback made an entity at the same line, and none was destroyed or cancelled.

    Timers that were called only once may be meant for one call, and count no earlier than at their second.
    """

    id = "never-destroyed"
    summary = "a callback makes a timer or the like each time it runs, and keeps them all"
    threshold = 5

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each line with enough calls that made something there."""
        timeline = view.timeline
        for making, calls in timeline.makings.items():
            if making.kind not in _WHY or len(calls) < self.threshold:
                continue
            first = next(iter(calls))
            repeats = making.kind is not EntityKind.TIMER or _calls(first, timeline) > 1
            if (
                repeats
                and len({*calls.values()}) >= self.threshold
                and not is_models(timeline.entities[first])
            ):
                about, begun = f"{making.file}:{making.line}", min(calls.values())
                yield Finding(self, begun, view.end, making.maker, first, about, size=len(calls))

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        kind = timeline.entities[found.culprit].kind
        file, line = timeline.entities[found.culprit].made_at
        always = found.size == _calls(found.subject, timeline)
        often = "each time it runs" if always else "again and again"
        return Explanation(
            f"{who(found.subject, timeline)} makes a {kind.value} at line {line} {often}: "
            f"{found.size} so far, and none was destroyed",
            _WHY[kind],
            f"make it once, in __init__, or destroy_{kind.value}() the former one",
            line_location(file, line),
        )


def _calls(entity: EntityId, timeline: Timeline) -> int:
    return timeline.calls_of(entity, Window(0, timeline.end + 1))
