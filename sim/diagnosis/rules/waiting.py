"""Rules on callbacks that were ready and did not run."""

from collections import defaultdict
from collections.abc import Iterator
from typing import ClassVar

from sim.diagnosis.cures import Remedy, remedy_for_waits, who_moves
from sim.diagnosis.edits.flags import event_setters
from sim.diagnosis.edits.spins import spin_beside, spin_node_beside, spins_in_turn, started_late, taken_away
from sim.diagnosis.rule import (
    CodeLocation,
    Explanation,
    Finding,
    Rule,
    Weight,
    by_edit,
    entity_of,
    line_of,
    loop_beside_spin,
    place_of,
)
from sim.diagnosis.rules.awaits import awaits_in_vain, awaits_in_vain_since, let_complete
from sim.diagnosis.rules.edits import not_reached
from sim.diagnosis.rules.locks import let_return, weight_beside_lock
from sim.diagnosis.time_limits import ends_by_itself
from sim.diagnosis.timeline_view import LongWait, TimelineView, raised_last
from sim.diagnosis.words import (
    SPIN_BESIDE,
    SPIN_ONCE,
    group_of,
    listed,
    often,
    only_thread,
    threads_for,
    who,
    who_waits,
)
from sim.quantities.durations import duration
from sim.quantities.nanoseconds import SECOND
from sim.trace.descriptions import node_name
from sim.trace.events import EntityId, EntityKind, GroupKind, NodeId, Reason
from sim.trace.model import EntityInfo, Nanoseconds, Window
from sim.trace.timeline import Timeline

HALF_A_SECOND = SECOND // 2
_SOON: Nanoseconds = SECOND // 20
"""A timer's wait that is shorter is never long, however short its period."""
_HABIT = 3
"""The number of waits from which on their share of a timer's calls counts."""


class _KeptWaiting(Rule):
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
                if waited < _long_for(entity) or _may_wait_for_its_caller(entity, wait, view):
                    continue
                shares: defaultdict[EntityId, Nanoseconds] = defaultdict(int)
                for part in parts:
                    shares[part.holder] += wait.length(part)
                culprit = max(shares, key=shares.__getitem__)
                if culprit not in view.nested_spinners:
                    yield Finding(self, wait.since, wait.until, entity.id, culprit, size=waited)

    def weigh(self, found: Finding, timeline: Timeline) -> Weight | None:
        """Irrelevant if it is a timer that seldom waits, not for long; a remark if its culprit waits too."""
        calls = timeline.calls_of(found.subject, Window(0, timeline.end + 1))
        if found.size < HALF_A_SECOND and found.count < max(_HABIT, calls / 3):
            return None
        return weight_beside_lock(found.culprit, Window(found.at, found.until), timeline)

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
            f"{names} waited {up_to}{duration(found.lasted)}: {cause}{times}",
            why,
            cure,
            place or place_of(found.subject, timeline),
            remedies=remedies,
        )


class GroupStarvation(_KeptWaiting):
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
        place = line_of(found.culprit, Window(found.at, found.until), timeline)
        setters = event_setters(place.file, place.first_line) if place else ()
        awaited = [each for each in (who(each, timeline) for each in waited) if each in setters]
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
            held = f"{awaits_in_vain(culprit, place, since)}, and keeps {group} meanwhile"
            room = Remedy((found.culprit,))
            cure = f"{room.words(timeline)}, and {let_complete(place)}"
        return self._explained(found, timeline, held, why, cure, room)


class NoFreeWorker(_KeptWaiting):
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
        else:
            busy = f"all threads were busy, one with {culprit}"
        why = "its group would have let it in, but a callback also needs a thread to run on"
        return self._explained(found, timeline, busy, why, cure, room)

    def weigh(self, found: Finding, timeline: Timeline) -> Weight | None:
        """Irrelevant if the culprit also kept others out of its group, which is told with this."""
        kept = _others_waiting(found, Reason.GROUP_HELD, timeline)
        asked = (EntityKind.CLIENT, EntityKind.SERVICE)
        is_told = any(timeline.entities[each].kind not in asked for each in kept)
        return None if is_told else super().weigh(found, timeline)


class BehindOthers(_KeptWaiting):
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


class NodeNeverSpins(Rule):
    """A callback of a node is ready, and no executor spins the node, unless an exception ended that.

    None need be ready if the program is in a loop of its own before anything spins. Of a program that waits
    for a service the rule on that tells.
    """

    id = "node-never-spins"
    summary = "callbacks are ready and nobody spins their node"
    dated_by_first = True
    threshold = SECOND

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield for each node the callback that has waited longest."""
        at = view.timeline.program_at(view.end)
        if at is not None and at.call == "Client.wait_for_service":
            return
        taken = {clash.node for clash in view.timeline.spin_clashes}
        for node, wait in view.unspun.items():
            name = node_name(node, view.timeline)
            since = wait.parts[-1].start
            is_long = view.end - since >= self.threshold
            if is_long and node not in taken and raised_last(node, view.timeline) is None:
                first, size = self._first_of(node, view), view.end - since
                yield Finding(self, first, view.end, wait.entity, about=name, size=size)
        yield from () if view.unspun else self._in_loop(view)

    def _first_of(self, node: NodeId, view: TimelineView) -> Nanoseconds:
        """When the first wait of a node began that lasted as long."""
        waits = [wait for each in view.entities() if each.node == node for wait in view.waits(each.id)]
        return min(
            part.start
            for wait in waits
            for part in wait.because(Reason.NOBODY_SPINS)
            if wait.length(part) >= self.threshold
        )

    def _in_loop(self, view: TimelineView) -> Iterator[Finding]:
        """Yield a callback that is not ready, if the program has been in one loop all the time lately."""
        timeline, before = view.timeline, max(0, view.end - self.threshold)
        positions = [timeline.program_at(each) for each in (before, view.end)]
        loops = {
            each.loop if each and each.call != "Client.wait_for_service" else ("", 0) for each in positions
        }
        loop = loops.pop() if len(loops) == 1 else ("", 0)
        if timeline.executors or not loop[0] or ends_by_itself(*loop):
            return
        for each in view.few_entities:
            if place_of(each.id, timeline) is not None:
                yield Finding(self, 0, view.end, each.id, about=node_name(each.node, timeline))
                return

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        subject = who(found.subject, timeline)
        node = timeline.entities[found.subject].node
        ever = any(
            each.node == node and timeline.calls_of(each.id, Window(0, timeline.end + 1))
            for each in timeline.entities.values()
        )
        place, at = place_of(found.subject, timeline), timeline.program_at(found.until)
        spins: tuple[int, ...] = ()
        remedies: tuple[Remedy, ...] = ()
        what = "nobody spins its node any more" if ever else "nobody ever spun its node"
        why = "callbacks run only inside spin()"
        cure = "call rclpy.spin(node), or add the node to an executor and spin that"
        if timeline.executors and not ever:
            what = "none of the spinning executors has its node"
            cure = (
                "add the node to an executor that spins: one that is only made runs nothing, "
                "and a second spin() is not reached before the first one returns"
            )
            spins = spins_in_turn(place.file) if place and at is None else ()
        elif ever:
            cure = "keep spinning the node: spin() has returned, or its executor was shut down"
        if place and spins:
            cure = SPIN_ONCE
            what, place, remedies = not_reached(place.file)
        elif place and timeline.executors and not ever and at is None:
            what, cure, place = _taken_or_late(what, cure, place)
        loop, how = loop_beside_spin(found.until, timeline)
        if at is not None and not ever:
            place = CodeLocation(*at.place, at.place[1])
            what = f"the program is at line {place.first_line}, and has come to no spin() so far"
            if at.call == "Client.call":
                what = f"the program waits in {at.call}() at line {place.first_line}, and nothing spins"
                cure = "use call_async() there, and rclpy.spin_until_future_complete(node, future)"
        if loop is not None:
            how_often = "spins too rarely" if ever else "comes to no spin()"
            place, cure = loop, how
            what = f"the program is in the loop of line {loop.first_line}, and {how_often}"
            remedies = by_edit(loop, "spin the node in a thread beside the loop", spin_node_beside)
        if loop is not None and cure is SPIN_BESIDE:
            what = f"the program waits in Rate.sleep() at line {loop.first_line}, and nothing spins"
            why = "a rate's timer is a callback too: callbacks run only inside spin()"
            remedies = by_edit(loop, "spin the node in a thread beside the loop", spin_beside)
        ready = f"has been ready for {duration(found.size)} and does not run" if found.size else "cannot run"
        if found.about not in subject:
            subject = f"{subject} of {found.about}"
        return Explanation(f"{subject} {ready}: {what}", why, cure, place, remedies=remedies)


def _taken_or_late(what: str, cure: str, place: CodeLocation) -> tuple[str, str, CodeLocation]:
    """Tell of a node that a second executor took away, or that only a thread spins which starts too late."""
    line, node, first, second = taken_away(place.file, place.first_line)
    spin, start = started_late(place.file)
    earlier = f"start the thread of line {start} before the spin() of line {spin}, which does not return"
    if line:
        what = f"{second}.add_node({node}) of line {line} took the node away from {first}"
        cure = (
            f"leave that line out: a node is in one executor at a time{f'; and {earlier}' if start else ''}"
        )
    elif start:
        what, cure = (
            f"the spin() of line {spin} has not returned, so that line {start} was not reached",
            earlier,
        )
    return what, cure, CodeLocation(place.file, line or start, line or start) if line or start else place


def _long_for(entity: EntityInfo) -> Nanoseconds:
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
            and min(wait.end_at(timeline.end), at.end) - wait.start >= _long_for(entity)
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
