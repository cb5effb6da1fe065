"""Rules on callbacks that were ready and did not run."""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from typing import ClassVar

from sim.diagnosis.awaits import awaits_in_vain, awaits_in_vain_since, let_complete
from sim.diagnosis.cures import Remedy, remedy_for_waits, who_moves
from sim.diagnosis.edits.flags import event_setters
from sim.diagnosis.rule import (
    Explanation,
    Finding,
    Rule,
    Weight,
    entity_of,
    line_of,
    place_of,
)
from sim.diagnosis.rules.locks import LET_GO, let_return, weight_beside_lock
from sim.diagnosis.timeline_view import LongWait, TimelineView
from sim.diagnosis.words import (
    group_of,
    listed,
    lock_keeper,
    often,
    only_thread,
    threads_for,
    who,
    who_waits,
)
from sim.quantities.durations import duration
from sim.quantities.nanoseconds import SECOND
from sim.trace.events import EntityId, EntityKind, GroupKind, Reason
from sim.trace.figures.waiting import waited_by
from sim.trace.model import EntityInfo, Nanoseconds, Window
from sim.trace.timeline import Timeline

HALF_A_SECOND = SECOND // 2
_SOON: Nanoseconds = SECOND // 20
"""A timer's wait that is shorter is never long, however short its period."""
_HABIT = 3
"""The number of waits from which on their share of a timer's calls counts."""
_IN_TIME = 0.9
"""The share of its ticks at which a timer must come lest it come too seldom."""


class KeptWaiting(Rule):
    """Others kept a ready callback waiting longer than the threshold in total, for one reason.

    A timer that misses a tick meanwhile waits long, too, if that happens at most of its calls.
    """

    is_effect = by_culprit = True
    reason: ClassVar[Reason]

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield such waits."""
        for entity in view.entities():
            for wait in view.waits(entity.id):
                parts = wait.because(self.reason)
                waited = sum(map(wait.length, parts))
                if waited < long_for(entity) or _may_wait_for_its_caller(entity, wait, view):
                    continue
                shares: defaultdict[EntityId, Nanoseconds] = defaultdict(int)
                for part in parts:
                    shares[part.holder] += wait.length(part)
                culprit = max(shares, key=shares.__getitem__)
                if culprit not in view.nested_spinners:
                    since = wait.until - waited_by(wait.until, wait.parts[-1], view.timeline)
                    size = waited + wait.since - since
                    yield Finding(self, since, wait.until, entity.id, culprit, size=size)

    def weigh(self, found: Finding, timeline: Timeline) -> Weight | None:
        """A remark if its culprit waits too, and of a timer that seldom waits, not for long, but comes too
        seldom by that; other such timers are irrelevant.
        """
        if found.size < HALF_A_SECOND and self._of_habit(found, timeline) is None:
            return Weight.REMARK if found.count >= _HABIT and _lost_rate(found, timeline) else None
        return weight_beside_lock(found.culprit, Window(found.at, found.until), timeline)

    def _of_habit(self, found: Finding, timeline: Timeline) -> Weight | None:
        """Return the rule's weight if that happens at a third of the callback's calls, else None."""
        calls = timeline.calls_of(found.subject, Window(0, timeline.end + 1))
        return None if found.count < max(_HABIT, calls / 3) else self.weight

    def _waiting(self, found: Finding, timeline: Timeline) -> list[EntityId]:
        """Return the callbacks that waited for the culprit at the worst time, the longest wait first."""
        return [found.subject, *_others_waiting(found, self.reason, timeline)]

    def _explained(
        self, found: Finding, timeline: Timeline, cause: str, why: str, cure: str, *remedies: Remedy
    ) -> Explanation:
        waited = self._waiting(found, timeline)
        names = listed(who_waits(each, Window(found.at, found.until), timeline) for each in waited)
        up_to, times = ("up to ", "") if len(waited) > 1 else ("", often(found.count))
        place = line_of(found.culprit, Window(found.at, found.until), timeline)
        return Explanation(
            f"{names} waited {up_to}{duration(found.lasted)}: {cause}{times}{_lost_rate(found, timeline)}",
            why,
            cure,
            place or place_of(found.subject, timeline),
            remedies=remedies,
        )


def _lost_rate(found: Finding, timeline: Timeline) -> str:
    """Tell how often a timer comes that waits for less than half a second at a time, if that is too seldom.

    Of a timer that comes even less often than its waits explain, as it was cancelled, nothing is told.
    """
    period = entity_of(found, timeline).period
    calls = timeline.spans_of(found.subject, Window(0, timeline.end + 1))
    if not period or found.size >= HALF_A_SECOND or len(calls) < 2:
        return ""
    lasted, ticks = calls[-1].start - calls[0].start, len(calls) - 1
    lost = lasted - ticks * period
    if not (1 - _IN_TIME) * lasted < lost <= found.count * found.size:
        return ""
    return f"; it comes at {ticks * SECOND / lasted:.3g} Hz in place of {SECOND / period:.3g} Hz"


class GroupStarvation(KeptWaiting):
    """A callback was ready, but another one held its mutually exclusive group.

    Others that waited for the culprit's thread meanwhile are part of the finding.

    Source: the ROS 2 how-to guide "Using callback groups".
    """

    id = "group-starvation"
    summary = "a callback waits long because its group is held"
    reason = Reason.GROUP_HELD

    def _waiting(self, found: Finding, timeline: Timeline) -> list[EntityId]:
        return [
            *super()._waiting(found, timeline),
            *_others_waiting(found, Reason.NO_FREE_WORKER, timeline),
        ]

    def kind(self, found: Finding, timeline: Timeline) -> str:
        """Distinguish groups that a suspended callback keeps, and those beside which threads were free."""
        if found.culprit in timeline.ever_suspended:
            return "group-kept-by-await"
        has_threads = threads_for([found.culprit], found.until, timeline) > 1
        return "group-held-beside-threads" if has_threads else self.id

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        culprit = who(found.culprit, timeline)
        waited = self._waiting(found, timeline)
        mover = who_moves(waited, found.culprit, timeline)
        room = remedy_for_waits(waited, mover, Window(found.at, found.until), timeline)
        awaited = _awaited(found, waited, timeline)
        why = f"{_admission(found.subject, timeline)}, however many threads are free"
        sooner = let_return(found.culprit, Window(found.at, found.until), timeline)
        cure = f"{room.words(timeline)}; or {sooner}"
        if awaited:
            why, cure = f"{why}, and {culprit} waits for what {listed(awaited)} sets", room.words(timeline)
        group, busy = group_of(found.subject, timeline), ""
        if _others_waiting(found, Reason.NO_FREE_WORKER, timeline):
            is_only = threads_for([found.culprit], found.until, timeline) == 1
            busy = f", on {only_thread(timeline)}" if is_only else ", and all threads were busy"
        held = f"{group} was held by {culprit}{busy}"
        window = Window(found.at, found.until)
        if (since := awaits_in_vain_since(found.culprit, window, timeline)) is not None:
            place = line_of(found.culprit, window, timeline)
            held = f"{awaits_in_vain(culprit, place, since)}, and keeps {group} meanwhile"
            room = Remedy((found.culprit,))
            cure = f"{room.words(timeline)}, and {let_complete(place)}"
        return self._explained(found, timeline, held, why, cure, room)


def _awaited(found: Finding, waited: Sequence[EntityId], timeline: Timeline) -> list[str]:
    """Return which of those that waited set what the culprit waits for, as its source shows."""
    place = line_of(found.culprit, Window(found.at, found.until), timeline)
    setters = event_setters(place.file, place.first_line) if place else ()
    return [each for each in (who(each, timeline) for each in waited) if each in setters]


class NoFreeWorker(KeptWaiting):
    """A callback's group was free, but every thread of its executor was busy."""

    id = "no-free-worker"
    summary = "a callback waits long because all threads are busy"
    reason = Reason.NO_FREE_WORKER

    def kind(self, found: Finding, timeline: Timeline) -> str:
        """Distinguish one thread, that of another node or of an action's goal, and threads in a lock."""
        subject, culprit = entity_of(found, timeline), timeline.entities.get(found.culprit)
        if threads_for([found.culprit, found.subject], found.until, timeline) > 1:
            at = timeline.positions_of(found.culprit, Window(found.at, found.until))
            return "threads-wait-for-lock" if any(each.waits_for_lock for each in at) else self.id
        if culprit is not None and culprit.node != subject.node:
            return "thread-kept-by-another-node"
        is_action = subject.kind is EntityKind.WAITABLE
        return "action-waits-for-thread" if is_action else "one-thread-for-all"

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        culprit = who(found.culprit, timeline)
        beside_itself = len(timeline.spans_of(found.culprit, Window(found.at, found.at + 1)))
        room = remedy_for_waits([found.subject], found.subject, Window(found.at, found.until), timeline)
        cure = f"{room.words(timeline)}, or keep {culprit} short"
        if threads_for([found.culprit, found.subject], found.until, timeline) == 1:
            busy = f"{only_thread(timeline)} ran {culprit}"
        elif beside_itself > 1:
            every = threads_for([found.culprit], found.until, timeline)
            busy = f"{beside_itself} calls of {culprit} kept a thread each; no thread was free"
            if beside_itself == every:
                busy = f"{'both' if every == 2 else f'all {every}'} threads ran {culprit}"
            room = Remedy((found.culprit,))
            outside = "then its calls wait outside, without a thread"
            cure = f"give {culprit} a MutuallyExclusiveCallbackGroup: {outside}"
            if self.kind(found, timeline) == "threads-wait-for-lock":
                cure += "; for a lock they wait inside, and one more thread would wait there too"
        elif waiters := _wait_for_its_lock(found, timeline):
            waiting = listed([who(each, timeline) for each in waiters])
            busy = f"{culprit} held a lock for which {waiting} waited, and no thread was free"
            room, cure = Remedy(), f"in {culprit}, {LET_GO}; one more thread may wait for it, too"
        else:
            busy = f"all threads were busy, one with {culprit}"
        why = "its group would have let it in, but a callback also needs a thread to run on"
        if awaited := _awaited(found, self._waiting(found, timeline), timeline):
            why, cure = f"{why}, and {culprit} waits for what {listed(awaited)} sets", room.words(timeline)
        return self._explained(found, timeline, busy, why, cure, room)

    def weigh(self, found: Finding, timeline: Timeline) -> Weight | None:
        """Irrelevant if the culprit also kept others out of its group, which is told with this.

        A remark if others waited on their threads for a lock that the culprit held.
        """
        if _wait_for_its_lock(found, timeline):
            return Weight.REMARK
        kept = _others_waiting(found, Reason.GROUP_HELD, timeline)
        asked = (EntityKind.CLIENT, EntityKind.SERVICE)
        is_told = any(timeline.entities[each].kind not in asked for each in kept)
        return None if is_told else super().weigh(found, timeline)


class BehindOthers(KeptWaiting):
    """A callback was ready, but its EventsExecutor was running what came before it.

    Source: rclpy's ``events_executor.cpp``, which has one queue and ignores callback groups.
    """

    id = "behind-others"
    summary = "a callback waits long behind others in the event queue"
    reason = Reason.EVENT_QUEUE

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        culprit = who(found.culprit, timeline)
        group = timeline.entities[found.culprit].group
        is_shared = timeline.entities[found.subject].group == group
        apart = f", and give {culprit} a callback group of its own" if is_shared else ""
        return self._explained(
            found,
            timeline,
            f"the EventsExecutor was running {culprit}",
            "an EventsExecutor asks no group: it runs one callback at a time, in order of arrival",
            f"keep {culprit} short, or let a MultiThreadedExecutor with more than one thread run both{apart}",
        )


def _wait_for_its_lock(found: Finding, timeline: Timeline) -> list[EntityId]:
    """Return the other callbacks that waited, in the middle of a wait, for a lock that its culprit held."""
    middle = (found.at + found.until) // 2
    there = (timeline.position_on(each, middle) for each in timeline.threads)
    waiting = (each for each in there if each and each.waits_for_lock and each.entity != found.culprit)
    callbacks = (each.entity for each in waiting if lock_keeper(each, timeline) == found.culprit)
    return [*dict.fromkeys(filter(None, callbacks))]


def long_for(entity: EntityInfo) -> Nanoseconds:
    """Return from which length on a wait is long: for timers, from that at which they miss a tick."""
    if entity.kind is not EntityKind.TIMER:
        return HALF_A_SECOND
    return min(HALF_A_SECOND, max(2 * entity.period, _SOON))


def _others_waiting(found: Finding, reason: Reason, timeline: Timeline) -> list[EntityId]:
    """Return the callbacks but a finding's own that waited long for its culprit then, for a reason."""
    at = Window(found.at, found.until)
    return [
        each
        for each, entity in timeline.entities.items()
        if each not in (found.subject, found.culprit)
        and any(
            wait.holder == found.culprit
            and wait.reason is reason
            and min(wait.end_at(timeline.end), at.end) - wait.start >= long_for(entity)
            for wait in timeline.waits_of(each, at)
        )
    ]


def _may_wait_for_its_caller(entity: EntityInfo, wait: LongWait, view: TimelineView) -> bool:
    """Whether a request or reply may wait for its own caller, which other rules cover."""
    if entity.kind is EntityKind.CLIENT and wait.is_open:
        return True
    holders = {part.holder for part in wait.parts}
    return entity.kind in (EntityKind.CLIENT, EntityKind.SERVICE) and any(
        view.stood_in_call(holder, wait.since, wait.until) for holder in holders
    )


def _admission(entity: EntityId, timeline: Timeline) -> str:
    group = timeline.groups.get(timeline.entities[entity].group)
    if group is None or group.kind is GroupKind.EXCLUSIVE:
        return "a mutually exclusive group lets one callback in at a time"
    return f"a {group.class_name} decides by itself whom it lets in"
