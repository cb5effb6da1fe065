"""Rules on nodes that nobody spins, or that are spun too rarely."""

from collections.abc import Iterator
from dataclasses import replace

from sim.diagnosis.cures import Remedy
from sim.diagnosis.edits.spins import (
    loop_of_spin_once,
    spin_beside,
    spin_executor,
    spin_node_beside,
    spin_past,
    spins_in_turn,
    started_late,
    taken_away,
)
from sim.diagnosis.rule import (
    CodeLocation,
    Explanation,
    Finding,
    Rule,
    Weight,
    by_edit,
    line_location,
    loop_beside_spin,
    made_in,
    place_of,
)
from sim.diagnosis.rules.edits import not_reached
from sim.diagnosis.rules.waiting import KeptWaiting
from sim.diagnosis.time_limits import ends_by_itself
from sim.diagnosis.timeline_view import TimelineView, raised_last
from sim.diagnosis.words import SPIN_ALWAYS, SPIN_BESIDE, SPIN_ONCE, who
from sim.quantities.durations import duration
from sim.quantities.nanoseconds import SECOND
from sim.trace.descriptions import node_name
from sim.trace.events import EntityId, NodeId, Reason
from sim.trace.model import Nanoseconds, Window
from sim.trace.timeline import Timeline


class NodeNeverSpins(Rule):
    """A callback of a node is ready, and no executor spins the node, unless an exception ended that.

    None need be ready if the program is in a loop of its own before anything spins. Of a program that waits
    for a service the rule on that tells.
    """

    id = "node-never-spins"
    summary = "callbacks are ready and nobody spins their node"
    dated_by_first = True
    hides = frozenset(("spins-too-rarely",))
    threshold = SECOND

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield for each node the callback that has waited longest."""
        at = view.timeline.program_at(view.end)
        if at is not None and at.call == "Client.wait_for_service":
            return
        clashes = view.timeline.spin_clashes
        if any(each.function == "spin" and not each.entity and not each.node for each in clashes):
            return  # one of two threads that spin one executor serves nothing, and the rule on that tells
        taken = {clash.node for clash in clashes}
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
            if ever and not _spun_before(found.subject, timeline):
                how_often, cure = "spins no more", f"keep spinning the node: {how}"
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


class SpinPastExecutor(Rule):
    """An executor with threads was given a node and runs nothing: ``rclpy.spin(node)`` spins another one."""

    id = "spin-past-executor"
    summary = "rclpy.spin(node) spins another executor than the one that was given the node"
    hides = frozenset(
        (
            "group-starvation",
            "no-free-worker",
            "stale-data",
            "dropped-messages",
            "groups-change-nothing",
            "threads-never-used",
        )
    )
    threshold: Nanoseconds = SECOND

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield it if an executor has had no worker for so long, and a file of the program shows why."""
        timeline = view.timeline
        if view.end < self.threshold:
            return
        working = {each.executor for each in timeline.threads.values()}
        idle = any(each.threads > 1 and each.id not in working for each in timeline.executors.values())
        if not idle or not view.threads_needed:
            return
        for file in made_in(view.few_entities):
            line, executor = spin_past(file)
            if line:
                yield Finding(self, self.threshold, view.end, about=executor, detail=file, size=line)

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        place = line_location(found.detail, found.size)
        cure = f"call {found.about}.spin() in its place"
        return Explanation(
            f"rclpy.spin() of line {found.size} spins another executor; {found.about}, which was given the "
            "node and has threads, is never spun",
            "rclpy.spin(node) takes the node into the global executor, which has one thread: a node is in "
            "one executor at a time",
            cure,
            place,
            remedies=by_edit(place, cure, spin_executor, found.about),
        )


class SpinsTooRarely(KeptWaiting):
    """A timer misses ticks at most of its calls, as the program spins its node now and then only.

    While one is as long as that of a node that nobody spins, the rule on that tells.
    """

    id = "spins-too-rarely"
    summary = "a timer misses ticks because its node is spun now and then only"
    reason = Reason.NOBODY_SPINS

    def weigh(self, found: Finding, timeline: Timeline) -> Weight | None:
        """Irrelevant if the timer seldom waits so."""
        return self._of_habit(found, timeline)

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        loop, cure = loop_beside_spin(found.at + found.size // 2, timeline)
        known = place_of(found.subject, timeline)
        if loop is None and known is not None:
            loop = line_location(known.file, loop_of_spin_once(known.file))
        where = f"the loop of line {loop.first_line} comes" if loop else "the program comes"
        told = self._explained(
            found,
            timeline,
            f"{where} to spin_once() too rarely",
            "callbacks run only inside spin(), and spin_once() returns after the first one",
            cure or SPIN_ALWAYS,
        )
        return replace(told, place=loop or told.place)


def _spun_before(entity: EntityId, timeline: Timeline) -> bool:
    """Whether a callback has waited for somebody to spin lately, and was called then."""
    waits = timeline.waits_of(entity, Window(0, timeline.end + 1))[-_LATELY:]
    begun = timeline.calls_begun(entity, Window(0, timeline.end + 1))[:1]
    return any(
        each.end is not None and each.reason is Reason.NOBODY_SPINS and each.start > begun[0].start
        for each in waits
        if begun
    )


_LATELY = 100


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
