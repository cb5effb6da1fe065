"""Rules on timers that are never due, or always, as some guards; and on times of a clock that is set back."""

from bisect import bisect_left
from collections.abc import Iterable, Iterator
from itertools import chain, islice

from sim.diagnosis.edits.clocks import follow_jumps, kept_at
from sim.diagnosis.edits.polling import leave_out
from sim.diagnosis.edits.timers import (
    keep_the_fraction,
    leave_sim_time_off,
    sim_time_set_at,
    sleeps_by_clock_at,
    triggered_at,
)
from sim.diagnosis.rule import (
    Explanation,
    Finding,
    Rule,
    by_edit,
    entity_of,
    is_models,
    line_location,
    made_at,
    place_of,
)
from sim.diagnosis.timeline_view import TimelineView
from sim.diagnosis.words import listed, who
from sim.quantities.durations import duration
from sim.quantities.nanoseconds import SECOND
from sim.trace.events import Doing, EntityId, EntityKind
from sim.trace.events import TimesKept as Kept
from sim.trace.model import EntityInfo, Nanoseconds, Span, Window
from sim.trace.timeline import Timeline


class ClockNeverStarts(Rule):
    """The timers of a node with ``use_sim_time`` never run: nothing has been sent on ``/clock``.

    A timer of another clock runs all the same: only one that should have run twice by now is told. Where none
    is, a callback that sleeps by the node's clock is, or, if none of the node's has run, such a line.
    """

    id = "clock-never-starts"
    summary = "timers, or sleeps, follow /clock, on which nothing is sent"
    threshold: Nanoseconds = SECOND

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield for each such node the first of its timers."""
        timeline = view.timeline
        if view.known < self.threshold or _CLOCK in timeline.names_sent:
            return
        every = view.few_entities
        for clock in every:
            if clock.name == _CLOCK and is_models(clock) and not _calls(clock.id, timeline):
                still = _never_ran(clock, every, timeline)
                file, line = ("", 0) if still else _sleeps_at(clock, view)
                if still or line:
                    subject = still[0] if still else 0
                    yield Finding(self, 0, view.end, subject, clock.id, detail=file, size=line)

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        clock = timeline.entities[found.culprit]
        still = _never_ran(clock, timeline.entities.values(), timeline)
        file = clock.made_at[0]
        line, place = sim_time_set_at(file), line_location(found.detail, found.size)
        what, then = f"the sleep of line {found.size} does not end", "no sleep by it ends"
        if place is None:
            never = f"never {'runs' if len(still) == 1 else 'run'}"
            what, then = f"{listed(who(each, timeline) for each in still)} {never}", "no timer is due"
        return Explanation(
            f"{what}: use_sim_time is true, and nothing has been sent on {_CLOCK}",
            f"the time of such a node is what {_CLOCK} says last: it is 0 until something comes, and {then}",
            f"start what publishes {_CLOCK} (a simulator, or ros2 bag play --clock); without one leave "
            "use_sim_time false",
            place or line_location(file, line) or place_of(found.subject, timeline) or made_at(clock),
            remedies=by_edit(line_location(file, line), "leave use_sim_time false", leave_sim_time_off),
        )


_CLOCK = "/clock"


def _sleeps_at(clock: EntityInfo, view: TimelineView) -> tuple[str, int]:
    """Return where a node's callback sleeps by its clock, or, if none has run, a line that would; else 0."""
    timeline = view.timeline
    for at in view.positions:
        waits = at.call.startswith("Clock.sleep") and at.doing is Doing.WAITS
        if waits and at.entity and timeline.entities[at.entity].node == clock.node:
            return at.file, at.line
    file, line = clock.made_at[0], sleeps_by_clock_at(clock.made_at[0])
    idle = not any(_calls(each.id, timeline) for each in view.few_entities if each.node == clock.node)
    return (file, line) if line and idle else ("", 0)


def _never_ran(clock: EntityInfo, among: Iterable[EntityInfo], timeline: Timeline) -> list[EntityId]:
    """Return the timers of a clock's node that should have run twice by now, if none of them has."""
    return [
        each.id
        for each in among
        if each.kind is EntityKind.TIMER
        and each.node == clock.node
        and 2 * each.period <= timeline.end
        and not _calls(each.id, timeline)
    ]


class TimesKept(Rule):
    """A node goes on with times of its simulated clock from before that was set back."""

    id = "times-kept"
    summary = "a node keeps times of a simulated clock that is set back"
    known_from_start = True

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each node of which the trace says so, with the callback that sets the time if it is known."""
        for event in view.timeline.times_kept.values():
            every = view.timeline.entities.values()
            own = [each for each in every if each.node == event.node and place_of(each.id, view.timeline)]
            line = kept_at(own[0].file, event.attributes[0]) if own else 0
            setter = (each for each in own if each.first_line <= line <= each.last_line)
            for entity in islice(chain(setter, own), 1):
                yield Finding(self, event.t, view.end, entity.id, event=event)

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        event, entity = found.event, entity_of(found, timeline)
        assert isinstance(event, Kept)
        line = kept_at(entity.file, event.attributes[0])
        place, names = line_location(entity.file, line), listed(event.attributes)
        is_one = len(event.attributes) == 1
        was, lies, it = ("was", "lies", "it") if is_one else ("were", "lie", "them")
        return Explanation(
            f"{names} {was} kept when sim time was set back by {duration(event.length)}",
            f"rclpy tells timers of a jump, but not what a node remembers: {names} {lies} in the future "
            "until the clock comes there again",
            f"set {it} back, or forget {it}, in a jump callback: get_clock().create_jump_callback()",
            place or place_of(found.subject, timeline),
            remedies=by_edit(place, f"set {names} back with the clock", follow_jumps, *event.attributes),
        )


class AlwaysDue(Rule):
    """A timer's period is 0, so that it is called again and again without a pause."""

    id = "always-due"
    summary = "a timer of period 0 is called without a pause"
    hides = frozenset(("still-computing",))
    threshold = 1000

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each timer with that many calls."""
        for entity in view.entities(EntityKind.TIMER):
            calls = _calls(entity.id, view.timeline) if entity.period == 0 else 0
            if calls >= self.threshold:
                yield Finding(self, 0, view.end, entity.id, entity.id, size=calls)

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        subject, made = who(found.subject, timeline), made_at(entity_of(found, timeline))
        return Explanation(
            f"the period of {subject} is 0 s: it is due all the time, and has run {found.size} times",
            "a timer is due again as soon as its period is over: with 0 the executor never rests, and on "
            "virtual time no time goes by",
            "give it a period in seconds; // leaves the fraction off: 1 // 50 is 0, and 1 / 50 is 0.02",
            made or place_of(found.subject, timeline),
            for_ever=_stops_time(timeline),
            remedies=by_edit(made, "keep the fraction of the period", keep_the_fraction),
        )


class TriggersItself(Rule):
    """The callback of a guard condition triggers that again, so that it is called again and again."""

    id = "triggers-itself"
    summary = "the callback of a guard condition triggers it again, without a pause"
    hides = frozenset(("still-computing",))
    threshold = 500
    """Calls within a second that count as no pause."""

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each guard condition that has been called so often lately, if its source shows why."""
        for entity in view.entities(EntityKind.GUARD):
            calls = view.timeline.calls_begun(entity.id, Window(0, view.end + 1))
            is_lately = bool(calls) and view.end - calls[-1].start < SECOND // 10

            def is_often(call: Span, guard: EntityId = entity.id) -> bool:
                lately = Window(call.start - SECOND, call.start + 1)
                return view.timeline.calls_of(guard, lately) >= self.threshold

            if is_lately and is_often(calls[-1]) and _triggered_at(entity):
                begun = max(0, bisect_left(calls, True, key=is_often) - self.threshold + 1)
                yield Finding(self, calls[begun].start, view.end, entity.id, entity.id, size=len(calls))

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        subject, entity = who(found.subject, timeline), entity_of(found, timeline)
        place = line_location(entity.file, _triggered_at(entity))
        return Explanation(
            f"{subject} triggers its own guard condition: it is called again and again, {found.size} times",
            "whoever triggers a guard condition lets its callback run once more: the executor never rests, "
            "and on virtual time no time goes by",
            "leave that trigger() out, or do the next step in a timer's callback, which comes after a period",
            place,
            for_ever=_stops_time(timeline),
            remedies=by_edit(place, "leave trigger() out", leave_out),
        )


def _triggered_at(guard: EntityInfo) -> int:
    """Return the line at which the callback of a guard condition triggers that; 0 for none."""
    file, made = guard.made_at
    return triggered_at(file, made, guard.first_line) if file == guard.file else 0


def _stops_time(timeline: Timeline) -> bool:
    return timeline.started is not None and timeline.started.clock != "real"


def _calls(entity: EntityId, timeline: Timeline) -> int:
    return timeline.calls_of(entity, Window(0, timeline.end + 1))
