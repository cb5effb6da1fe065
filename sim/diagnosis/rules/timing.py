"""Rules on the duration of callbacks and its effects."""

from collections.abc import Iterator, Sequence
from itertools import pairwise

from sim.diagnosis.awaits import awaits_in_vain, awaits_in_vain_since, let_complete, waits_for_no_reply
from sim.diagnosis.edits.profiles import set_depth
from sim.diagnosis.edits.replies import go_on_in_done_callback
from sim.diagnosis.edits.shared_data import guards_what_it_changes
from sim.diagnosis.rule import (
    Explanation,
    Finding,
    Rule,
    Weight,
    by_edit,
    entity_of,
    is_models,
    line_location,
    line_of,
    made_at,
    place_of,
    positions_of_call,
)
from sim.diagnosis.rules.edits import edits_for_rounds
from sim.diagnosis.rules.locks import weight_beside_lock
from sim.diagnosis.rules.waiting import long_for
from sim.diagnosis.shares import asked_by_turns, room_for, what_it_takes
from sim.diagnosis.timeline_view import TimelineView
from sim.diagnosis.words import (
    awaited_lock,
    group_of,
    listed,
    lock_keeper,
    lock_taker,
    often,
    only_thread,
    threads_for,
    who,
    with_threads,
)
from sim.quantities.durations import duration
from sim.quantities.nanoseconds import SECOND
from sim.trace.events import EntityKind, GroupKind
from sim.trace.model import AWAIT, EntityInfo, Span, Window
from sim.trace.timeline import Timeline

_HABIT = 3
"""The number of overruns from which on their share counts."""
_IN_VAIN = 3 * SECOND
"""How long an await that keeps nobody else waiting lasts before it is told."""
_CALLS_IN_TURN = 5
"""The number of calls, one right after the other, that tell a habit."""


class OverlappingCallback(Rule):
    """A callback started while an earlier call of it was running, which a reentrant group allows.

    Where no lock guards what they share, both calls can overwrite each other's changes. The trace shows a
    lock only where a call waits for it: such an overlap is a remark. So are those of services, for which
    there are reentrant groups.
    """

    id = "overlapping-callback"
    summary = "a callback runs several times at once"
    is_effect = True

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
        subject = who(found.subject, timeline)
        cure = f"give {subject} a MutuallyExclusiveCallbackGroup, or guard what its calls share with a lock"
        if entity_of(found, timeline).kind is EntityKind.TIMER:
            cure += "; a callback shorter than the timer's period never overlaps"
        lock = _lock_line(found, timeline)
        unguarded = "where no lock guards what its calls share, one can undo what the other changed"
        if lock is not None:
            cure = f"give {subject} a MutuallyExclusiveCallbackGroup: who waits there keeps no thread"
            unguarded = (
                f"the lock of line {lock} lets one of them on at a time, and guards nothing outside it"
            )
        return Explanation(
            f"{subject} overlapped itself for {duration(found.lasted)}{often(found.count)}",
            f"a reentrant group lets the same callback in again; {unguarded}",
            cure,
            line_of(found.subject, Window(found.at, found.until), timeline),
        )

    def weigh(self, found: Finding, timeline: Timeline) -> Weight | None:
        """A problem where timers or subscriptions, hardly meant to overlap, wait for no lock meanwhile.

        Irrelevant where the source shows a lock around all that matters, for which no call waits, and where a
        call waits for a reply that does not come.
        """
        entity = entity_of(found, timeline)
        if waits_for_no_reply(entity.id, timeline):
            return None
        if _lock_line(found, timeline) is not None:
            return Weight.REMARK
        if guards_what_it_changes(entity.file, entity.first_line):
            return None
        is_meant = entity.kind not in (EntityKind.TIMER, EntityKind.SUBSCRIPTION)
        return Weight.REMARK if is_meant else Weight.PROBLEM


def _lock_line(found: Finding, timeline: Timeline) -> int | None:
    """Return the line at which a call waits for a lock meanwhile; None if none does."""
    positions = timeline.positions_of(found.subject, Window(found.at, found.until))
    return next((each.line for each in positions if each.waits_for_lock), None)


class OverrunTimer(Rule):
    """A timer's callback took longer than its period, or awaited something that long, so ticks were missed.

    Source: rcl skips the periods that have passed when a timer is called late.
    """

    id = "overrun-timer"
    summary = "a timer's callback takes longer than its period"
    is_effect = True

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each call or await longer than the period, unless the next call overlaps it."""
        for entity in view.entities(EntityKind.TIMER):
            if entity.period == 0 or entity.id in view.nested_spinners:
                continue
            for each in _awaits(entity, view):
                if (length := each.end - each.start) > entity.period:
                    yield Finding(self, each.start, each.end, entity.id, entity.id, size=length)
            spans = view.spans(entity.id)
            for place, span in enumerate(spans):
                end = span.end_at(view.end)
                beside = spans[place + 1 : place + 2]
                if end - span.start > entity.period and not (beside and beside[0].start < end):
                    length = end - span.start
                    yield Finding(self, span.start, end, entity.id, entity.id, size=length)

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        entity = entity_of(found, timeline)
        alone = threads_for([found.subject], found.until, timeline) == 1
        threads = f", with {with_threads(2)}" if alone else ""
        missed = (found.lasted - 1) // entity.period
        ticks = "1 tick" if missed == 1 else f"{missed} ticks"
        subject, during = who(found.subject, timeline), Window(found.at, found.until)
        place = line_of(found.subject, during, timeline)
        if (since := awaits_in_vain_since(found.subject, during, timeline)) is not None:
            why = "a timer is not called again before its callback is over"
            return Explanation(awaits_in_vain(subject, place, since), why, let_complete(place), place)
        locks = [each for each in positions_of_call(found.subject, during, timeline) if each.waits_for_lock]
        why = "the timer is not called again before its callback is over; missed ticks are not made up for"
        cure = f"let {subject} return sooner: do long work step by step, or in a callback of another group"
        cure, remedies = cure + threads, edits_for_rounds(place, found.subject, timeline)
        if waits := _waits_for_reply(found, timeline):
            why = f"{why}; a callback keeps its group while it waits for a reply, and while it awaits one"
            cure = f"return from {subject}, and go on in a done-callback of the future"
            cure += ", which call_async() returns" if "Client.call" in waits else ""
            remedies = by_edit(place, "go on in a done-callback of the future", go_on_in_done_callback)
        if found.lasted / 2 < (waited := sum(each.end_at(found.until) - each.start for each in locks)):
            longest = max(locks, key=lambda each: each.end_at(found.until) - each.start)
            taker = lock_taker(longest, timeline)
            why = f"{duration(waited)} of that it waited for {awaited_lock(longest, timeline)}; {why}"
            whom = f"let {taker}" if taker else "find who keeps the lock, and"
            cure = f"{whom} let go of {'the lock' if taker else 'it'} before anything that takes long"
            keeper = line_of(lock_keeper(longest, timeline), during, timeline)
            place, remedies = keeper or line_location(*longest.taken_at) or place, ()
        spans = timeline.spans_of(found.subject, Window(found.at, found.at + 1))
        goes_on = timeline.ended is None and any(
            span.end is None and span.start == found.at for span in spans
        )
        took = f"has run for {duration(found.lasted)} so far" if goes_on else f"took {duration(found.lasted)}"
        return Explanation(
            f"{subject} {took} with a period of {duration(entity.period)}; "
            f"{ticks} missed or late{often(found.count, 'overruns in all')}",
            why,
            cure,
            place,
            remedies=remedies,
        )

    def kind(self, found: Finding, timeline: Timeline) -> str:
        """Distinguish what is late by a wait for a reply."""
        return "overrun-by-a-reply" if _waits_for_reply(found, timeline) else self.id

    def weigh(self, found: Finding, timeline: Timeline) -> Weight | None:
        """A problem if most calls overrun by what they do, not for a lock that others hold; else a remark.

        A timer that was called once has missed nothing: its callback may cancel it. What it awaits in vain is
        told where others wait for it.
        """
        if awaits_in_vain_since(found.subject, Window(found.at, found.until), timeline) is not None:
            waits = timeline.moment(found.until).waiting.values()
            keeps = any(each.holder == found.subject != each.entity for each in waits)
            return None if keeps or found.lasted < _IN_VAIN else Weight.PROBLEM
        calls = timeline.calls_of(found.subject, Window(0, timeline.end + 1))
        if calls < 2 or waits_for_no_reply(found.subject, timeline):
            return None
        if found.count < _HABIT or 2 * found.count < calls:
            return Weight.REMARK
        return weight_beside_lock(found.subject, Window(found.at, found.until), timeline)


def _waits_for_reply(found: Finding, timeline: Timeline) -> set[str]:
    """Return the calls in which a callback waits for a reply at the line where it is longest, or awaits."""
    during = Window(found.at, found.until)
    place = line_of(found.subject, during, timeline)
    return {
        each.call
        for each in positions_of_call(found.subject, during, timeline)
        if each.call in ("Client.call", AWAIT)
        and place is not None
        and (place.file, place.first_line) in ((frame.file, frame.line) for frame in each.frames)
    }


def _awaits(entity: EntityInfo, view: TimelineView) -> Iterator[Window]:
    """Yield when calls of an entity were suspended; they keep others out in an exclusive group alone."""
    is_alone = _kind_of_group(entity, view) is GroupKind.EXCLUSIVE
    if is_alone and entity.id in view.timeline.ever_suspended:
        for each in view.timeline.positions_of(entity.id, view.window):
            if each.call == AWAIT:
                yield Window(each.start, each.end_at(view.end))


def _kind_of_group(entity: EntityInfo, view: TimelineView) -> GroupKind | None:
    group = view.timeline.groups.get(entity.group)
    return None if group is None else group.kind


class Overload(Rule):
    """Timers of one thread or group come too seldom, each too late by little: they ask for more than all of
    its time. Told where no call takes longer than its period, and no wait is long: of those others tell.
    """

    id = "overload"
    summary = "timers ask for more time than their thread or group has"
    is_effect = by_culprit = True

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield the timers that come too seldom, if there are few callbacks."""
        timers = (each for each in view.entities(EntityKind.TIMER) if each.period and not is_models(each))
        for entity in timers if view.few_entities else ():
            calls = view.timeline.spans_of(entity.id, Window(0, view.end + 1))[-_LATELY:]
            window = Window(calls[0].start, calls[-1].start) if len(calls) == _LATELY else Window(0, 0)
            is_short = 0 < window.length <= _STRETCH
            if not is_short or (_LATELY - 1) * entity.period > _OFTEN_ENOUGH * window.length:
                continue
            asked = asked_by_turns(entity, window, view.timeline)
            long = any(wait.until - wait.since >= long_for(entity) for wait in view.waits(entity.id))
            if not long and (size := round(100 * sum(asked.values()))) >= _TOO_MUCH:
                most = max(asked, key=asked.__getitem__)
                yield Finding(self, window.start, window.end, entity.id, most, size=size)

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        entity, window = entity_of(found, timeline), Window(found.at, found.until)
        asked = asked_by_turns(entity, window, timeline)
        threads = threads_for([entity.id], found.until, timeline)
        one = "one thread runs" if threads == 1 else "a mutually exclusive group lets in"
        whose = only_thread(timeline) if threads == 1 else group_of(entity.id, timeline)
        asking = listed(who(each, timeline) for each in asked)
        shares = [what_it_takes(each, share, found.until, timeline) for each, share in asked.items()]
        comes = f"{(_LATELY - 1) * SECOND / window.length:.3g} Hz in place of {SECOND / entity.period:.3g} Hz"
        rooms = (room_for(asked, threads, timeline),) if max(asked.values()) < 1 else ()
        less = f"let {asking} take less time, or timers be due less often"
        return Explanation(
            f"{asking} ask{'s' * (len(asked) == 1)} for {found.size} % of the time of {whose}: "
            f"{who(entity.id, timeline)} comes at {comes}",
            f"{one} one callback at a time; {listed(shares)}",
            "; or ".join([*(room.words(timeline) for room in rooms), less]),
            place_of(found.culprit, timeline),
            remedies=rooms,
        )


_LATELY = 8
"""The last calls of a timer by which it is judged."""
_STRETCH = 5 * SECOND
"""The longest time that these may take: no more events than of that are looked at."""
_OFTEN_ENOUGH = 0.9
_TOO_MUCH = 105
"""Per cent of the time from which on that is too much."""


class MeantInMilliseconds(Rule):
    """A timer is due so seldom that its period may have been meant in milliseconds.

    Not told of whole minutes, and of what it has been called for.
    """

    id = "meant-in-milliseconds"
    summary = "a timer's period is hundreds of seconds"
    weight = Weight.REMARK

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each such timer that has not been called."""
        for each in view.few_entities if view.end >= SECOND else ():
            seconds, part = divmod(each.period, SECOND)
            is_odd = not part and 100 <= seconds <= 10_000 and seconds % 60
            is_called = is_odd and view.timeline.calls_of(each.id, Window(0, view.end + 1))
            if is_odd and each.kind is EntityKind.TIMER and not is_called and not is_models(each):
                yield Finding(self, 0, view.end, each.id)

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        entity = entity_of(found, timeline)
        seconds = entity.period // SECOND
        return Explanation(
            f"{who(found.subject, timeline)} is due every {seconds} s, and has not been called yet",
            "create_timer() counts in seconds",
            f"if milliseconds are meant, give it {seconds / 1000:g}",
            made_at(entity),
        )


class FallsBehind(Rule):
    """A subscription's calls take longer than its messages are apart, so it takes older and older ones.

    Once messages are lost, that is told instead.
    """

    id = "falls-behind"
    summary = "a callback takes longer than its messages are apart, so they grow old in its queue"
    is_effect = True
    threshold = SECOND

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each call that took an old message, if those before it kept the messages waiting."""
        for entity in view.entities(EntityKind.SUBSCRIPTION):
            for span in view.spans(entity.id):
                is_old = span.age >= self.threshold and span.end is not None
                if is_old and calls_outrun(entity, span, _CALLS_IN_TURN, view.timeline):
                    yield Finding(self, span.start, span.end_at(view.end), entity.id, size=span.age)

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        subject, place = who(found.subject, timeline), place_of(found.subject, timeline)
        made = made_at(entity_of(found, timeline))
        return Explanation(
            f"{subject} falls behind: it takes {duration(found.lasted)} a message, and took one that was "
            f"{duration(found.size)} old",
            "its messages come faster than that, so its queue grows, and what it does is about the past",
            f"let {subject} return sooner, or keep only the newest message by a queue of 1",
            line_of(found.subject, Window(found.at, found.until), timeline) or place,
            remedies=by_edit(made, f"give {subject} a queue of 1", set_depth, 1),
        )

    def weigh(self, found: Finding, timeline: Timeline) -> Weight | None:
        """Irrelevant once its queue has lost messages."""
        if timeline.losses_of(found.subject, Window(0, timeline.end + 1)):
            return None
        return weight_beside_lock(found.subject, Window(found.at, found.until), timeline)


def calls_outrun(entity: EntityInfo, last: Span, number: int, timeline: Timeline) -> Sequence[Span]:
    """Return the ``number`` calls up to one if they followed each other at once, each with an older message,
    and left more; else none.

    Of a burst of messages each is older, too, but fewer and fewer are left.
    """
    calls = timeline.spans_of(entity.id, Window(0, last.start + 1))[-number:]
    left = [timeline.queue(entity.id, each.start).depth for each in calls]
    outrun = (
        len(calls) == number
        and left[0] < left[-1]
        and all(
            one.end is not None
            and other.start - one.end <= (one.end - one.start) // 10
            and other.age > one.age
            for one, other in pairwise(calls)
        )
    )
    return calls if outrun else ()
