"""Rules on the duration of callbacks and its effects."""

from collections.abc import Iterator

from sim.diagnosis.cures import cure_for_waits
from sim.diagnosis.rule import Explanation, Finding, Rule, Weight, entity_of, place_of
from sim.diagnosis.timeline_view import TimelineView
from sim.diagnosis.words import group_of, listed, often, threads_for, who, with_threads
from sim.durations import duration
from sim.trace.events import EntityId, EntityKind, GroupKind, Reason
from sim.trace.model import EntityInfo, Nanoseconds, Span, Wait, Window
from sim.trace.timeline import Timeline

_HABIT = 3
"""The number of overruns from which on their share counts."""


class OverlappingCallback(Rule):
    """A callback started while an earlier call of it was running, which a reentrant group allows.

    Without a lock, which the trace does not show, both calls can overwrite each other's changes. Services are
    what reentrant groups are made for, so their overlaps are a remark.
    """

    id = "overlapping-callback"
    summary = "a callback runs several times at once"

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each call that started while another one was running."""
        for entity in view.entities():
            if entity.kind is EntityKind.CLIENT or _kind_of_group(entity, view) is GroupKind.EXCLUSIVE:
                continue
            latest = -1
            for span in view.spans(entity.id):
                end = span.end_at(view.end)
                shared = min(latest, end)
                if span.start < shared:
                    yield Finding(self, span.start, shared, entity.id, entity.id, size=shared - span.start)
                latest = max(latest, end)

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        """Name the race condition."""
        subject = who(found.subject, timeline)
        cure = (
            f"give {subject} a MutuallyExclusiveCallbackGroup, or see that a lock guards what its calls share"
        )
        if entity_of(found, timeline).kind is EntityKind.TIMER:
            cure += "; a callback shorter than the timer's period never overlaps"
        return Explanation(
            f"{subject} ran twice at once for {duration(found.lasted)}{often(found.count)}",
            "a reentrant group lets the same callback in again; without a lock, one call can undo what the "
            "other changed",
            cure,
            place_of(found.subject, timeline),
        )

    def weigh(self, found: Finding, timeline: Timeline) -> Weight:
        """A problem for timers and subscriptions, which are hardly meant to overlap."""
        meant = entity_of(found, timeline).kind not in (EntityKind.TIMER, EntityKind.SUBSCRIPTION)
        return Weight.REMARK if meant else Weight.PROBLEM


class OverrunTimer(Rule):
    """A timer's callback took longer than its period, so ticks were missed.

    Source: rcl skips the periods that have passed when a timer is called late.
    """

    id = "overrun-timer"
    summary = "a timer's callback takes longer than its period"

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each call longer than the period, unless the next one overlaps it."""
        for entity in view.entities(EntityKind.TIMER):
            if entity.period == 0:
                continue
            spans = view.spans(entity.id)
            for place, span in enumerate(spans):
                end = span.end_at(view.end)
                beside = spans[place + 1 : place + 2]
                if end - span.start > entity.period and not (beside and beside[0].start < end):
                    length = end - span.start
                    yield Finding(self, span.start, end, entity.id, entity.id, size=length)

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        """Count the ticks that the longest call missed."""
        entity = entity_of(found, timeline)
        alone = threads_for([found.subject], found.until, timeline) == 1
        threads = f", with {with_threads(2)}" if alone else ""
        missed = (found.lasted - 1) // entity.period
        ticks = "1 tick" if missed == 1 else f"{missed} ticks"
        subject = who(found.subject, timeline)
        return Explanation(
            f"{subject} took {duration(found.lasted)} with a period of {duration(entity.period)}: "
            f"{ticks} missed or late{often(found.count, 'overruns in all')}",
            "the timer is not called again before its callback is over; missed ticks are not made up for",
            f"let {subject} return sooner: do long work step by step, or in a callback of another group"
            + threads,
            place_of(found.subject, timeline),
        )

    def weigh(self, found: Finding, timeline: Timeline) -> Weight | None:
        """A problem if most calls overrun, else a remark.

        A timer that was called once has missed nothing: its callback may cancel it.
        """
        calls = timeline.calls_of(found.subject, Window(0, timeline.end + 1))
        if calls < 2:
            return None
        return Weight.PROBLEM if found.count >= _HABIT and 2 * found.count >= calls else Weight.REMARK


class LongCallbackAmongSensors(Rule):
    """A callback sleeps, or works long, in an exclusive group that subscriptions share."""

    id = "long-callback-among-sensors"
    summary = "a callback sleeps or works long in a group of subscriptions"
    threshold: Nanoseconds = 500_000_000

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each call that kept subscriptions of its group waiting longer than the threshold."""
        told: set[tuple[EntityId, Nanoseconds]] = set()
        for sensor in view.entities(EntityKind.SUBSCRIPTION):
            for wait in view.waits(sensor.id):
                for part in wait.because(Reason.GROUP_HELD):
                    for span in self._spans_behind(part, part.start + wait.length(part), view):
                        if (span.entity, span.start) not in told:
                            told.add((span.entity, span.start))
                            end = span.end_at(view.end)
                            size = end - span.start
                            yield Finding(self, span.start, end, span.entity, span.entity, size=size)

    def _spans_behind(self, part: Wait, until: Nanoseconds, view: TimelineView) -> Iterator[Span]:
        holder = view.timeline.entities.get(part.holder)
        if until - part.start < self.threshold or holder is None or holder.id in view.nested_spinners:
            return
        if _kind_of_group(holder, view) is GroupKind.EXCLUSIVE:
            for span in view.spans(holder.id):
                end = span.end_at(view.end)
                is_long = min(end, until) - max(span.start, part.start) >= self.threshold
                if is_long and not view.stood_in_call(holder.id, span.start, end):
                    yield span

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        """Name the subscriptions."""
        subject = who(found.subject, timeline)
        entity = entity_of(found, timeline)
        sensors = [
            each
            for each in timeline.group_members(entity.group)
            if each.kind is EntityKind.SUBSCRIPTION and each.id != entity.id
        ]
        room = cure_for_waits(
            [each.id for each in sensors], found.subject, Window(found.at, found.until), timeline
        )
        return Explanation(
            f"{subject} slept or worked for {duration(found.lasted)} in {group_of(found.subject, timeline)}, "
            f"which it shares with {listed(each.spoken_name for each in sensors)}{often(found.count)}",
            "while it sleeps it holds the group, and nothing comes in from the sensors",
            f"{room}; or let {subject} return at once, and go on in a timer",
            place_of(found.subject, timeline),
        )


def _kind_of_group(entity: EntityInfo, view: TimelineView) -> GroupKind | None:
    group = view.timeline.groups.get(entity.group)
    return None if group is None else group.kind
