"""Rules on spinning in the wrong place: inside a callback, and inside a node's constructor."""

from collections.abc import Iterator

from sim.diagnosis.cures import Remedy
from sim.diagnosis.edits.flags import setters
from sim.diagnosis.edits.polling import leave_out
from sim.diagnosis.edits.spins import (
    await_in_loop,
    never_made,
    spun_in_threads,
    starving_loop,
)
from sim.diagnosis.lasting_waits import SETTLES
from sim.diagnosis.rule import (
    CodeLocation,
    Explanation,
    Finding,
    Rule,
    Weight,
    by_edit,
    line_location,
    made_in,
)
from sim.diagnosis.rules.edits import edits_for_reply, edits_for_spinning, not_reached
from sim.diagnosis.rules.known_errors import SPUN_TWICE
from sim.diagnosis.timeline_view import TimelineView
from sim.diagnosis.words import (
    SPIN_ONCE,
    awaiting,
    group_of,
    is_task,
    listed,
    must_answer,
    often,
    threads_for,
    who,
    with_threads,
)
from sim.quantities.durations import duration
from sim.quantities.nanoseconds import SECOND
from sim.trace.events import Doing, EntityId, EntityKind, GroupKind, NoticeKind, ProgramAt, SpinClashed
from sim.trace.model import Call, Nanoseconds, Position, Window
from sim.trace.timeline import Timeline


class NestedSpin(Rule):
    """A callback spins its own executor, or takes its node away from it; or two threads spin one executor.

    Since Jazzy 7.1.9 the executor raises. ``rclpy.spin_until_future_complete(node, future)`` and its like use
    the global executor: a node that another one spins is moved there, and is in none afterwards.
    """

    id = "nested-spin"
    summary = "a callback spins the executor that runs it"
    by_culprit = True
    hides = frozenset(("threads-never-used",))

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each attempt, and one that cannot end as long as it lasts."""
        spinning = {each.entity for each in view.positions if "spin" in each.call and _lasts(each, view)}
        latest = {each.entity: each for each in view.timeline.spin_clashes}
        for clash in reversed(view.timeline.spin_clashes):
            is_latest = latest[clash.entity] is clash
            held = _held_up(clash, view) if is_latest else ""
            waited = _program_waits(clash, view.timeline, view.end) if is_latest else 0
            stuck, until = frozenset[EntityId](), clash.t
            ring: tuple[str, ...] = ()
            if held and clash.entity in spinning:
                stuck, ring, until = frozenset([clash.entity]), _ring(clash, view.timeline), view.end
            elif waited >= SECOND:
                until = view.end
            elif clash.t <= view.window.start:
                continue
            yield Finding(
                self,
                clash.t,
                until,
                clash.entity,
                clash.entity,
                about=clash.function,
                size=waited,
                event=clash,
                detail=held,
                stuck=stuck,
                ring=ring,
            )

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        clash = found.event
        assert isinstance(clash, SpinClashed)
        subject = who(clash.entity, timeline) if clash.entity else "the program"
        runner = (
            f"the executor that runs {subject}" if clash.entity else "an executor that another thread spins"
        )
        if clash.node:
            node = timeline.nodes.get(clash.node, "its node")
            where = f" in {subject}" if clash.entity else ""
            what = (
                f"node {node} left its executor, which no longer serves it; "
                f"{clash.function}(){where} has taken it over"
            )
            why = (
                "a node is in one executor at a time: this one has it until the call returns, "
                "and then none has it"
            )
        else:
            what = f"{subject} spins {runner}, by {clash.function}()"
            why = (
                "an executor is spun once at a time; rclpy before Jazzy 7.1.9 does not refuse this: "
                f"it may hang, or raise {SPUN_TWICE}"
            )
            if clash.refused:
                what += ": RuntimeError: Executor is already spinning"
            elif _killed(clash, timeline):
                what += f": {SPUN_TWICE}, which ended that thread"
            elif self.weigh(found, timeline) is Weight.REMARK:
                why += "; cbtui explore looks for an order of threads in which it goes wrong"
        count = found.count
        if (waited := _program_waits(clash, timeline, found.until)) >= SECOND:
            call = _last_call(clash, timeline)
            answered = f", though its call of {call.service} was answered" if call else ""
            what, count = f"the program waits in {clash.function}() for {duration(waited)}{answered}", 1
            why = f"it spins {runner}, which may take what is to wake it: {why}"
        for_ever = bool(found.ring) and found.until >= timeline.end
        if for_ever:
            what = (
                f"deadlock: {subject} waits in {found.ring[1]} for ever; "
                f"{found.detail} {found.ring[2]}, which {subject} holds"
            )
            why = "it comes back when a callback of this group has run, and the group lets none in meanwhile"
        place = line_location(clash.file, clash.line)
        for file in () if place else made_in(timeline.entities.values()):
            for line in spun_in_threads(file):
                place = line_location(file, line)
        cure, remedies = _cure(clash, subject, timeline), _remedies(clash, place, timeline)
        what += often(count)
        return Explanation(what, why, cure, place, for_ever=for_ever, remedies=remedies)

    def weigh(self, found: Finding, timeline: Timeline) -> Weight | None:
        """A remark if nothing has come of it: two threads spin, no executor refused, and main has gone on."""
        clash = found.event
        assert isinstance(clash, SpinClashed)
        ended = timeline.ended
        is_harmful = clash.entity or clash.node or clash.refused or (ended is not None and ended.failed)
        if is_harmful or _killed(clash, timeline) or _program_waits(clash, timeline, found.until) >= SECOND:
            return Weight.PROBLEM
        return Weight.REMARK


class SpinInConstructor(Rule):
    """``__init__`` spins and does not return, so that no later line is ever run."""

    id = "spin-in-constructor"
    summary = "__init__ spins, and what follows never runs"
    threshold: Nanoseconds = SECOND

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield it once it has lasted."""
        for at in view.timeline.programs_at(view.end):
            in_constructor = any(function == "__init__" for _, function, _ in at.frames)
            if in_constructor and "spin" in at.call and view.end - at.t >= self.threshold:
                yield Finding(self, at.t, view.end, detail=at.call, event=at)

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        at = found.event
        assert isinstance(at, ProgramAt)
        file, _, line = at.frames[-1]
        place, spin = CodeLocation(file, line, line), found.detail.rpartition(".")[2]
        return Explanation(
            f"__init__ calls {spin}(), which does not come back: what follows line {line} never runs",
            _NEVER.format(spin),
            f"leave {spin}() out of __init__, and call rclpy.spin(node) in main() once the node is made",
            place,
            remedies=by_edit(place, f"leave {spin}() out of __init__", leave_out),
        )


class SpinNotReached(Rule):
    """A node is made only for a second ``spin()``, which is not reached: the first one does not return."""

    id = "spin-not-reached"
    summary = "a second spin() is not reached, nor the node that is made for it"
    threshold: Nanoseconds = SECOND

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each class of nodes of which no entity was made, while the program spins."""
        timeline = view.timeline
        if view.end < self.threshold or not timeline.executors:
            return
        if timeline.program_at(view.end) is not None:
            return
        ended = timeline.ended
        if timeline.processes_ended or (ended and ended.failed and not ended.time_was_up):
            return  # spin() has raised, or what came after it has
        for file, lines in made_in(view.few_entities).items():
            for name in never_made(file, lines):
                yield Finding(self, self.threshold, view.end, about=name, detail=file)

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        what, place, remedies = not_reached(found.detail)
        made = f"no {found.about} has been made: {what}"
        return Explanation(made, _NEVER.format("spin"), SPIN_ONCE, place, remedies=remedies)


class AsyncioStarved(Rule):
    """A coroutine spins in a loop without an ``await``, so that asyncio runs no other task meanwhile.

    Source: asyncio, which switches between tasks only where one awaits.
    """

    id = "asyncio-starved"
    summary = "a coroutine that spins in a loop never awaits"
    threshold: Nanoseconds = SECOND

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each such loop, as the files of the program show it, if anything has run."""
        if view.end < self.threshold or not view.threads_needed:
            return
        for file in made_in(view.few_entities):
            line, function, _ = starving_loop(file)
            if line:
                yield Finding(self, self.threshold, view.end, about=function, detail=file, size=line)

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        place = line_location(found.detail, found.size)
        _, _, others = starving_loop(found.detail)
        cure = "await asyncio.sleep(0) in each round of the loop"
        return Explanation(
            f"the loop of line {found.size} spins and never awaits: asyncio runs no other task while "
            f"{found.about} is in it, such as {' or '.join(others)}",
            "asyncio runs one task at a time, and another one only when that awaits; spin_once() does not",
            f"{cure}, or spin in a thread of its own",
            place,
            remedies=by_edit(place, cure, await_in_loop),
        )


_NEVER = "{0}() runs callbacks until the program ends; what is made after it never exists"
_LOOKED_AT = 100
"""Calls that are looked at for the program's last one."""


def _lasts(position: Position, view: TimelineView) -> bool:
    return position.doing is Doing.CALLS_ROS and view.end - position.start >= SETTLES


def _program_waits(clash: SpinClashed, timeline: Timeline, at: Nanoseconds) -> Nanoseconds:
    """Return how long a program has waited where it spins what another thread spins; 0 if for a reply."""
    program = None if clash.entity or not clash.endless else timeline.program_at(at)
    if program is None or (program.frames[-1][0], program.frames[-1][2]) != (clash.file, clash.line):
        return 0
    call = _last_call(clash, timeline)
    return 0 if call and call.replied is None else at - max(program.t, clash.t)


def _killed(clash: SpinClashed, timeline: Timeline) -> bool:
    """Return whether a thread of the program's was ended by what an executor raises that is spun twice."""
    died = (each for each in timeline.notices if each.kind is NoticeKind.THREAD_DIED and each.t >= clash.t)
    return any(each.error == SPUN_TWICE for each in died)


def _last_call(clash: SpinClashed, timeline: Timeline) -> Call | None:
    """Return the last call that the program made before it spun, if it was one of the last of all."""
    before = (each for each in reversed(timeline.calls[-_LOOKED_AT:]) if each.sent <= clash.t)
    return next((each for each in before if not each.caller), None)


def _held_up(clash: SpinClashed, view: TimelineView) -> str:
    """Return what a callback that spins without end keeps out of its group, so that it never returns; or "".

    That is either whatever its node has, or the replies to all calls of which it can wait for the future.
    """
    timeline = view.timeline
    known = timeline.entities.get(clash.entity)
    group = None if known is None else timeline.groups.get(known.group)
    if known is None or group is None or not clash.endless or clash.node not in (0, known.node):
        return ""
    if group.kind is not GroupKind.EXCLUSIVE:
        return ""
    served = (each for each in timeline.entities.values() if clash.node in (0, each.node))
    if all(each.group == group.id for each in served):
        return "all callbacks of its node are in"
    if not clash.function.endswith("future_complete"):
        return ""
    kept = {
        each.name: f"the reply of {each.name}" if each.kind is EntityKind.CLIENT else each.name
        for wait in timeline.moment(view.end).waiting.values()
        if wait.holder == clash.entity and view.end - wait.since >= SETTLES
        for each in [timeline.entities[wait.entity]]
        if each.group == group.id and each.kind in (EntityKind.CLIENT, EntityKind.SERVICE)
    }
    begun = timeline.spans_of(clash.entity, Window(clash.t, clash.t + 1))
    since = Window(begun[-1].start, view.end + 1) if begun else Window(clash.t, view.end + 1)
    called = {call.service for call in timeline.calls_within(since) if call.caller == clash.entity}
    if not called or not called <= kept.keys():
        return ""
    return f"{listed(kept[each] for each in sorted(called))} {'waits' if len(called) == 1 else 'wait'} for"


def _ring(clash: SpinClashed, timeline: Timeline) -> tuple[str, ...]:
    """Return the cycle of a callback that spins its node and keeps its group meanwhile."""
    subject, group = who(clash.entity, timeline), group_of(clash.entity, timeline)
    return subject, f"{clash.function}()", group, subject


def _remedies(clash: SpinClashed, place: CodeLocation | None, timeline: Timeline) -> tuple[Remedy, ...]:
    if not clash.entity:
        return ()
    if clash.function.endswith("future_complete"):
        return edits_for_reply(place, clash.entity, timeline)
    return edits_for_spinning(place, clash.entity, clash.function, timeline)


def _cure(clash: SpinClashed, subject: str, timeline: Timeline) -> str:
    if not clash.entity and clash.function in ("spin", "spin_once"):
        return (
            "let one executor have all nodes, and one thread spin it; or give each thread that spins an "
            "executor of its own: rclpy.spin(node) spins the same one everywhere"
        )
    if not clash.entity:
        return (
            "spin each node in one thread only; another thread waits for a future by a threading.Event "
            "that the future's done-callback sets"
        )
    if not clash.function.endswith("future_complete"):
        others = [each for each in setters(clash.file, clash.line) if each != subject]
        if others and not must_answer(clash.entity, timeline):
            return (
                f"return from {subject}, and go on in {listed(others)}: callbacks run by themselves as soon "
                f"as {subject} returns"
            )
        return (
            f"leave {clash.function}() out, and a loop around it, too: callbacks run by themselves as soon "
            f"as {subject} returns"
        )
    threads = ""
    if threads_for([clash.entity], clash.t, timeline) == 1:
        threads = f", and spin with {with_threads(2)}"
    awaits, groups = (
        awaiting(clash.entity, timeline),
        f", and give {subject} and the client a callback group each",
    )
    if is_task(clash.entity, timeline):
        groups = ""
    if must_answer(clash.entity, timeline):
        return (
            f"after call_async() {awaits}; to wait inside {subject}, use client.call(), and give {subject} a "
            f"callback group of its own{threads}"
        )
    return (
        f"after call_async() let {subject} return and go on in future.add_done_callback(), or {awaits}; to "
        f"wait inside {subject}, use client.call(){groups}{threads}"
    )
