"""The rule on subscriptions that hear their own messages, and so never come to rest."""

from bisect import bisect_left
from collections.abc import Iterator
from operator import attrgetter

from sim.diagnosis.rule import Explanation, Finding, Rule, place_of
from sim.diagnosis.timeline_view import TimelineView
from sim.diagnosis.words import listed, who
from sim.quantities.durations import duration
from sim.quantities.nanoseconds import SECOND
from sim.trace.events import EntityKind
from sim.trace.model import Nanoseconds, Span, Window
from sim.trace.timeline import Timeline

_OFTEN = 20
"""Calls within the threshold from which on their causes are looked for: other callbacks cost nothing."""
_IN_A_ROW = 200
_TRIED = 20 * _IN_A_ROW
"""The latest calls that are looked at: where the trace has lost an event, they seem to lead to nothing."""


class FeedbackLoop(Rule):
    """Calls of subscriptions cause one another: each publishes the message that leads to the next.

    Nothing but the time that the calls take paces such a loop.
    """

    id = "feedback-loop"
    summary = "subscriptions hear what they publish themselves, and never come to rest"
    hides = frozenset(("dropped-messages", "still-computing", "group-starvation", "no-free-worker"))
    threshold: Nanoseconds = SECOND
    """In which so many calls cause one another that nothing else can pace them."""

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield for each loop the subscription that was made first, from the begin of the loop."""
        for each in view.entities(EntityKind.SUBSCRIPTION):
            calls = view.timeline.calls_begun(each.id, Window(0, view.end + 1))
            for last in calls[-1:-_TRIED:-_IN_A_ROW]:
                members = {cause.entity for cause in self._loop(last, view.timeline)}
                if members and each.id == min(members):
                    first = bisect_left(calls, True, key=lambda call: bool(self._loop(call, view.timeline)))
                    begun = self._loop(calls[first], view.timeline)[-1].start
                    culprit = each.id if len(members) == 1 else 0
                    yield Finding(self, begun, last.start, each.id, culprit)
                    break

    def _loop(self, last: Span, timeline: Timeline) -> list[Span]:
        """Return the calls that led to one another, up to the last one; none if something paces them."""
        recent = Window(last.start - self.threshold, last.start + 1)
        causes = _causes(last, timeline) if timeline.calls_of(last.entity, recent) >= _OFTEN else []
        return causes if len(causes) == _IN_A_ROW and causes[-1].start >= recent.start else []

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        last = timeline.spans_of(found.subject, Window(found.until, found.until + 1))[-1]
        causes = _causes(last, timeline)
        members = sorted({each.entity for each in causes})
        names = listed(who(each, timeline) for each in members)
        topics = listed(sorted({timeline.entities[each].name for each in members}))
        took = last.start - causes[-1].start
        is_one = len(members) == 1
        return Explanation(
            f"{names} {'hears its' if is_one else 'hear their'} own messages on {topics}: {len(causes)} "
            f"calls in a row led to one another {f'in {duration(took)}' if took else 'at one moment'}",
            "a message goes to all subscriptions of its topic, also to those of the node that publishes it",
            f"publish on another topic than {names} hear{'s' * is_one}, or only what has changed",
            place_of(found.subject, timeline),
        )


def _causes(call: Span, timeline: Timeline) -> list[Span]:
    """Return a call of a subscription, the one that published its message, and so on, the latest first."""
    causes, latest = list[Span](), call
    while len(causes) < _IN_A_ROW and timeline.entities[latest.entity].kind is EntityKind.SUBSCRIPTION:
        causes.append(latest)
        sent = timeline.sent_on(timeline.entities[latest.entity].name)
        place = bisect_left(sent, latest.message, key=attrgetter("id"))
        sender = sent[place].sender if place < len(sent) and sent[place].id == latest.message else None
        if sender is None:
            break
        latest = sender
    return causes
