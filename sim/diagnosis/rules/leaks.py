"""The rule on callbacks that make one entity after another and keep them all."""

from collections import defaultdict
from collections.abc import Iterator

from sim.diagnosis.rule import Explanation, Finding, Rule, is_models, line_location
from sim.diagnosis.timeline_view import TimelineView
from sim.diagnosis.words import who
from sim.trace.events import EntityId, EntityKind, Notice, NoticeKind
from sim.trace.model import EntityInfo, Window
from sim.trace.timeline import Timeline

_WHY = {
    EntityKind.TIMER: "each of them goes on being called: they take more and more of the thread's time",
    EntityKind.SUBSCRIPTION: "each of them hears every message: it is handled once more with each",
    EntityKind.CLIENT: "each of them stays, and the executor looks at all of them again and again",
    EntityKind.SERVICE: "each of them stays and answers: a request is handled once more with each",
}

_WHY_NO_PUBLISHER = (
    "each of them stays, and has to find its subscriptions first: what it publishes at once may reach nobody"
)


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
            is_programs = not is_models(timeline.entities[first]) or _is_rate(timeline.entities[first])
            if repeats and len({*calls.values()}) >= self.threshold and is_programs:
                about, begun = f"{making.file}:{making.line}", min(calls.values())
                yield Finding(self, begun, view.end, making.maker, first, about, size=len(calls))
        yield from self._publishers(view)

    def _publishers(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each line of publishers, as the engine reports it whenever their number has doubled."""
        told: defaultdict[tuple[str, int], list[Notice]] = defaultdict(list)
        for notice in view.timeline.notices:
            if notice.kind is NoticeKind.PUBLISHERS_KEPT:
                told[notice.place].append(notice)
        for (file, line), notices in told.items():
            number, last = self.threshold << len(notices) - 1, notices[-1]
            if number == view.timeline.calls_of(last.entity, Window(0, last.t + 1)):
                number = _calls(last.entity, view.timeline)  # each call made one
            about = f"{file}:{line}"
            yield Finding(self, notices[0].t, view.end, last.entity, about=about, size=number, event=last)

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        if isinstance(found.event, Notice):
            kind, why, (file, line) = "publisher", _WHY_NO_PUBLISHER, found.event.place
        else:
            maker = timeline.entities[found.culprit]
            kind = "rate" if _is_rate(maker) else maker.kind.value
            why, (file, line) = _WHY[maker.kind], maker.made_at
        always = found.size == _calls(found.subject, timeline)
        often = "each time it runs" if always else "again and again"
        return Explanation(
            f"{who(found.subject, timeline)} makes a {kind} at line {line} {often}: "
            f"{found.size} so far, and none was destroyed",
            why,
            f"make it once, in __init__, or destroy_{kind}() the former one",
            line_location(file, line),
        )


def _is_rate(entity: EntityInfo) -> bool:
    """Whether it is the timer of a rate: the only one that rclpy makes where the program asks for another."""
    return entity.kind is EntityKind.TIMER and is_models(entity)


def _calls(entity: EntityId, timeline: Timeline) -> int:
    return timeline.calls_of(entity, Window(0, timeline.end + 1))
