"""Rules on messages that are lost, stale when used, or never delivered."""

from bisect import bisect, bisect_left
from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import groupby
from operator import attrgetter

from sim.diagnosis.cures import Remedy, remedy_for_waits
from sim.diagnosis.edits.profiles import (
    keep_for_late,
    match_quality,
    published_at,
    set_depth,
    unmatched_beside,
)
from sim.diagnosis.edits.shared_data import uses_what_is_set
from sim.diagnosis.edits.transforms import looks_up
from sim.diagnosis.rule import (
    Explanation,
    Finding,
    Rule,
    Weight,
    by_edit,
    entity_of,
    line_location,
    line_of,
    loop_beside_spin,
    made_at,
    place_of,
)
from sim.diagnosis.rules.locks import LET_GO, let_return, lock_that_kept
from sim.diagnosis.rules.transforms import LISTENER
from sim.diagnosis.timeline_view import LongWait, TimelineView, raised_last
from sim.diagnosis.words import awaited_lock, listed, lock_taker, often, who
from sim.quantities.durations import duration
from sim.quantities.nanoseconds import SECOND
from sim.trace.descriptions import why_waiting
from sim.trace.events import EntityId, EntityKind, QosMismatched, Reason
from sim.trace.model import EntityInfo, Nanoseconds, Position, Span, Window
from sim.trace.timeline import Timeline


class DroppedMessages(Rule):
    """Messages were lost because a queue was full or they exceeded their lifespan.

    A queue of one usually keeps the newest message on purpose, so its losses are a remark, unless three
    quarters of the messages are lost while others keep its callback waiting; so are losses of actions, whose
    queues are not the program's own.
    """

    id = "dropped-messages"
    summary = "messages are lost because a callback does not take them in time"
    is_effect = True
    dated_by_first = True

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield the losses of each second as one."""
        taken = {clash.node: clash.entity for clash in view.timeline.spin_clashes}
        for entity in view.entities():
            losses = view.timeline.losses_of(entity.id, view.window)
            if losses and (over := view.end_of_program(entity)) is not None:
                losses = [at for at in losses if at <= over]
            for _, each in groupby(losses, key=lambda at: at // SECOND):
                times = list(each)
                count = len(times)
                waits = view.timeline.waits_of(entity.id, Window(times[0], times[0] + 1))
                holder = waits[-1].holder if waits else 0
                if waits and waits[-1].reason is Reason.NOBODY_SPINS:
                    ended = raised_last(entity.node, view.timeline)
                    holder = ended.entity if ended else taken.get(entity.node, 0)
                yield Finding(
                    self, times[0], times[-1], entity.id, holder, due_to=holder, size=count, count=count
                )

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        entity = entity_of(found, timeline)
        subject = who(found.subject, timeline)
        taken = any(each.node == entity.node for each in timeline.spin_clashes)
        at = timeline.end if taken else _waited(found, timeline)  # a node is lost when its spin has returned
        waits = timeline.waits_of(entity.id, Window(at, at + 1))
        because, each_took, place = "", "", place_of(found.subject, timeline)
        own = _waits_for_itself(entity, at, timeline)
        if waits:
            if own:
                place = line_of(entity.id, Window(found.at, found.until + 1), timeline)
            because = (
                f" while its {'last call' if found.count == 1 else 'calls'} ran"
                if own
                else f" while it waited ({why_waiting(waits[-1], timeline)})"
            )
            calls = timeline.spans_of(entity.id, Window(found.at, found.until + 1))
            lengths = [each.end - each.start for each in calls if each.end is not None]
            if own and len(lengths) > 1:
                each_took = f"; each took {duration(sum(lengths) // len(lengths))}, and"
        room = remedy_for_waits([entity.id], entity.id, Window(found.at, found.until + 1), timeline)
        faster = f"let {subject} return sooner, or publish less often"
        cure = f"{room.words(timeline) or faster}; a longer queue only delays it"
        if lock := _lock_before(found, timeline):
            because, each_took, room = f" while it waited for {awaited_lock(lock, timeline)}", "", Remedy()
            cure = f"in {lock_taker(lock, timeline)}, {LET_GO}"
        if not waits and not _runs(entity.id, at, timeline) and (made := made_at(entity)):
            lossy = Window(found.at, found.until + 1)
            starts = [each.start for each in timeline.calls_begun(entity.id, lossy)]
            # What is lost between two calls came in one burst, however long that took.
            bursts = Counter(bisect(starts, each) for each in timeline.losses_of(entity.id, lossy))
            at_once = entity.depth + max(bursts.values())
            cure, place = f"give {subject} a queue of {at_once}", made
            (room,) = by_edit(made, cure, set_depth, at_once)
            cure += ": its messages come so many at once"
        if waits and waits[-1].reason is Reason.NOBODY_SPINS:
            (loop, how), room = loop_beside_spin(found.until, timeline), Remedy()
            cure, place = (how, loop) if loop else ("keep spinning its node", place)
            cure += "; a longer queue only delays it"
        sent = found.count + timeline.calls_of(entity.id, Window(0, timeline.end + 1))
        part = f"{found.count} of {sent}" if _keeps_little(entity, at, timeline) else str(found.count)
        messages = "1 message" if part == "1" else f"{part} messages"
        holds = f"{each_took or ':'} its queue holds {entity.depth}" if entity.depth else ""
        calls = timeline.spans_of(entity.id, Window(found.until - SECOND, found.until + 1))
        age = max((each.age for each in calls), default=0)
        old = f"; what {subject} took then was up to {duration(age)} old" if own and age >= SECOND else ""
        worst = f"; most in the second from {found.until // SECOND} s on, {found.size}"
        why = f"what comes into a full queue pushes the oldest out{worst if found.size < found.count else ''}"
        return Explanation(
            f"{subject} lost {messages}{because}{holds}",
            f"{why}{old}",
            cure,
            place,
            remedies=(room,),
        )

    def weigh(self, found: Finding, timeline: Timeline) -> Weight:
        """A remark for most queues of one, and where what keeps the callback waiting is the problem."""
        entity = entity_of(found, timeline)
        is_late = found.due_to or _lock_before(found, timeline)
        is_minor = is_late or (entity.depth <= 1 and not _keeps_little(entity, found.until, timeline))
        return Weight.REMARK if is_minor else Weight.PROBLEM


def _lock_before(found: Finding, timeline: Timeline) -> Position | None:
    """Return the wait for a lock of others in which a callback was most of the second before a loss."""
    return lock_that_kept(found.subject, Window(max(0, found.until - SECOND), found.until), timeline)


def _waited(found: Finding, timeline: Timeline) -> Nanoseconds:
    """Return the latest loss during a wait if that is usual among the latest ones, else the latest loss.

    Where waits were not seen, as on a busy machine, the latest during a call counts in the same way.
    """
    losses = timeline.losses_of(found.subject, Window(found.at, found.until + 1))[-_MANY:]
    waited = [each for each in losses if timeline.waits_of(found.subject, Window(each, each + 1))]
    ran = [each for each in losses if _runs(found.subject, each, timeline)]
    return next((each[-1] for each in (waited, ran) if 2 * len(each) > len(losses)), found.until)


def _runs(entity: EntityId, at: Nanoseconds, timeline: Timeline) -> bool:
    """Whether a callback ran before a moment, and in it."""
    return any(each.start < at for each in timeline.spans_of(entity, Window(at, at + 1)))


def _waits_for_itself(entity: EntityInfo, at: Nanoseconds, timeline: Timeline) -> bool:
    """Return whether a callback waits for an earlier call of its own."""
    waits = timeline.waits_of(entity.id, Window(at, at + 1))
    return bool(waits) and waits[-1].holder == entity.id


def _keeps_little(entity: EntityInfo, at: Nanoseconds, timeline: Timeline) -> bool:
    """Return whether a queue of one has lost three quarters of its messages, but not to calls of its own."""
    run = Window(0, timeline.end + 1)
    lost = timeline.drops_of(entity.id, run)
    is_part = lost >= _MANY and lost >= 3 * timeline.calls_of(entity.id, run)
    return entity.depth == 1 and is_part and not _waits_for_itself(entity, at, timeline)


_MANY = 10
"""The number of losses from which on it counts which part of the messages they are."""


class StaleData(Rule):
    """A timer's callback ran while a newer message than its node had seen had been waiting for long.

    It is not told where the source shows that the timer uses nothing that the waiting callback sets.
    """

    id = "stale-data"
    summary = "a timer decides on old data while newer messages wait"
    is_effect = True
    threshold: Nanoseconds = 200_000_000

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each timer call that ran while messages had waited longer than the threshold."""
        worst: dict[tuple[EntityId, Nanoseconds], Finding] = {}
        for sensor in view.entities(EntityKind.SUBSCRIPTION):
            timers = [each for each in view.entities(EntityKind.TIMER) if each.node == sensor.node]
            for found in self._of(sensor, timers, view):
                known = worst.get((found.subject, found.at))
                if known is None or known.size < found.size:
                    worst[found.subject, found.at] = found
        yield from worst.values()

    def _of(self, sensor: EntityInfo, timers: Sequence[EntityInfo], view: TimelineView) -> Iterator[Finding]:
        for wait in view.waits(sensor.id):
            is_long = wait.until - wait.since >= self.threshold
            if wait.longest_part(wait.until).reason is Reason.NOBODY_SPINS:
                continue  # its timer is spun as rarely
            if is_long and view.timeline.calls_of(sensor.id, Window(0, wait.since + 1)):
                for timer in timers:
                    calls = [each.start for each in self._uninformed_calls(view, timer.id, wait)]
                    for at in calls if calls and _may_use_what_is_set(sensor, timer) else ():
                        age, keeper = at - wait.since, wait.longest_part(at).holder
                        yield Finding(self, at, at, timer.id, sensor.id, due_to=keeper, size=age)

    def _uninformed_calls(self, view: TimelineView, timer: EntityId, wait: LongWait) -> Iterator[Span]:
        spans = view.spans(timer)
        first = bisect_left(spans, wait.since + self.threshold, key=attrgetter("start"))
        for span in spans[first:]:
            if span.start > wait.until:
                return
            if wait.is_open or span.start < wait.until or _is_before_the_first_of(wait, span, view):
                yield span

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        subject, sensor = who(found.subject, timeline), who(found.culprit, timeline)
        window = Window(found.at - found.size, found.at)
        room = remedy_for_waits([found.culprit], found.culprit, window, timeline)
        return Explanation(
            f"{subject} ran while newer messages had waited {duration(found.size)} for {sensor}"
            f"{often(found.count)}",
            f"if {subject} uses them, it decides on old data: it knows only what {sensor} has taken",
            room.words(timeline) or let_return(found.culprit, window, timeline),
            place_of(found.subject, timeline),
            remedies=(room,),
        )

    def weigh(self, found: Finding, timeline: Timeline) -> Weight:
        """A remark where what keeps the messages waiting is the problem."""
        return Weight.REMARK if found.due_to else Weight.PROBLEM


def _may_use_what_is_set(sensor: EntityInfo, timer: EntityInfo) -> bool:
    if sensor.file.endswith(LISTENER):
        return looks_up(timer.file, timer.first_line)
    is_known = sensor.file and sensor.file == timer.file
    return not is_known or uses_what_is_set(timer.file, sensor.first_line, timer.first_line) is not False


class SentTooEarly(Rule):
    """All messages of a topic were published before a subscription was matched, which hears none of them.

    Only what was published outside callbacks counts: a callback may publish again. rclpy's own topics, on
    which each node publishes when it is made, are left out.
    """

    id = "sent-too-early"
    summary = "what is published once comes before the publisher knows of the subscription"
    threshold: Nanoseconds = SECOND

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each subscription that has heard nothing, if nothing has been published for a while."""
        timeline = view.timeline
        for each in view.few_entities:
            if each.kind is not EntityKind.SUBSCRIPTION or not each.made_at[0] or each.name in _OF_RCLPY:
                continue
            sent = timeline.sent_on(each.name)
            if not sent or view.end - sent[-1].at < self.threshold or _has_got(each.id, timeline):
                continue
            is_told = any(each.id == mismatch.entity for mismatch in timeline.mismatches)
            if not is_told and len(sent) <= _FEW_SENT and all(one.sender is None for one in sent):
                yield Finding(self, sent[0].at, view.end, each.id, about=each.name, size=len(sent))

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        place, one = line_location(*entity_of(found, timeline).made_at), found.size == 1
        publisher = published_at(place.file, found.about) if place else 0
        by = f" (line {publisher})" if publisher else ""
        return Explanation(
            f"{who(found.subject, timeline)} hears nothing: {'the only' if one else f'all {found.size}'} "
            f"message{'' if one else 's'} of {found.about} {'was' if one else 'were'} published before the "
            "publisher knew of the subscription",
            "a publisher keeps its last messages for later subscriptions only if both are transient-local",
            f"make the publisher{by} and the subscription TRANSIENT_LOCAL, or publish later",
            place,
            remedies=by_edit(place, "keep the last messages for it", keep_for_late, publisher)
            if publisher
            else (),
        )


_OF_RCLPY = ("/parameter_events", "/rosout")
_FEW_SENT = 10
"""Messages that are looked at: who publishes more outside callbacks does so in a loop."""


def _has_got(entity: EntityId, timeline: Timeline) -> bool:
    queue = timeline.queue(entity, timeline.end)
    return bool(queue.depth or queue.dropped or timeline.calls_of(entity, Window(0, timeline.end + 1)))


class QosMismatch(Rule):
    """A publisher and a subscription of one topic are incompatible, so nothing is ever delivered.

    Source: the ROS 2 documentation, "Quality of Service settings".
    """

    id = "qos-mismatch"
    summary = "a subscription hears nothing because the quality of service, or the type, does not match"

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each incompatible pair."""
        for each in reversed(view.timeline.mismatches):
            if each.t <= view.window.start:
                return
            yield Finding(
                self,
                each.t,
                each.t,
                each.entity,
                about=each.topic,
                size=bool(each.publisher[0]),  # one of the program goes first: both ends can be named
                detail=each.policy,
                event=each,
            )

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        assert isinstance(found.event, QosMismatched)
        publisher = line_location(*found.event.publisher)
        subscription = line_location(*found.event.subscription)
        end = "a subscription of the program" if subscription else "a subscription outside the program"
        subject = who(found.subject, timeline) if found.subject else end
        outside = "" if publisher else " outside the program"
        ends = [
            f"the {name} of {place}"
            for name, place in zip(_ENDPOINTS, (publisher, subscription), strict=True)
            if place
        ]
        also: tuple[str, ...] = ()
        if publisher and subscription and publisher.file == subscription.file:
            lines = (publisher.first_line, subscription.first_line)
            also = unmatched_beside(publisher.file, found.detail, *lines)
        same, differs = "QoSProfile", f"{listed([found.detail, *also])} do{'' if also else 'es'} not match"
        words = _PROFILE_WORDS[bool(publisher) and (not subscription or found.detail == "DURABILITY")]
        if found.detail == _TYPE:
            same, differs, words = "message type", "message types differ", "take the type that is published"
        cure = f"give both ends of {found.about} the same {same}"
        cure += f": {' and '.join(ends)}" if ends else ""
        if len(ends) == 1:
            far = "subscription" if publisher else "publisher"
            change = _FITTING.get((found.detail, far)) or f"have the {same} of the {far}"
            cure = f"let {ends[0]} {change}: the {far} is outside the program"
        place = subscription or publisher
        # Who requests transient-local wants what was published before: with less, that would never come.
        edited = publisher or place if found.detail == "DURABILITY" else place
        other = next((each for each in (publisher, subscription) if each and edited and each != edited), None)
        seen = other.first_line if other and edited and other.file == edited.file else 0
        return Explanation(
            f"{differs}; {subject} hears nothing from a publisher of {found.about}{outside}",
            _POLICY_RULES.get(found.detail, "a publisher has to offer at least what a subscription requests"),
            cure,
            place or place_of(found.subject, timeline),
            remedies=by_edit(edited, words, match_quality, found.detail, seen),
        )

    def weigh(self, found: Finding, timeline: Timeline) -> Weight:
        """A remark on a publisher outside the program where the subscription hears from others."""
        assert isinstance(found.event, QosMismatched)
        outside = found.subject and not found.event.publisher[0]
        heard = outside and timeline.calls_of(found.subject, Window(0, timeline.end + 1))
        return Weight.REMARK if heard else Weight.PROBLEM


_PROFILE_WORDS = ("request no more than is offered", "offer what is requested")
_ENDPOINTS = ("publisher", "subscription")
_FITTING = {
    ("RELIABILITY", "publisher"): "request ReliabilityPolicy.BEST_EFFORT",
    ("RELIABILITY", "subscription"): "offer ReliabilityPolicy.RELIABLE",
    ("DURABILITY", "publisher"): "request DurabilityPolicy.VOLATILE",
    ("DURABILITY", "subscription"): "offer DurabilityPolicy.TRANSIENT_LOCAL",
}
"""What one end does to match the other end, by policy and by that other end."""


_TYPE = "TYPE"
_POLICY_RULES = {
    _TYPE: "a topic has one type: messages of another one reach nobody",
    "RELIABILITY": "a reliable subscription takes nothing from a best-effort publisher",
    "DURABILITY": "a transient-local subscription takes nothing from a volatile publisher",
}


def _is_before_the_first_of(wait: LongWait, timer: Span, view: TimelineView) -> bool:
    """Whether a timer call at the very end of a wait came before the call that had waited."""
    following = [each for each in view.spans(wait.entity) if each.start == wait.until]
    if not following or following[0].thread != timer.thread:
        return False
    lane = view.timeline.spans_on(timer.thread, Window(wait.until, wait.until + 1))
    entities = [span.entity for span in lane if span.start == wait.until]
    return entities.index(timer.entity) < entities.index(wait.entity)
