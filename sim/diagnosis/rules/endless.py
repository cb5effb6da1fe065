"""The rule on callbacks that wait for a lock that is not released or an event that is not set."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from sim.diagnosis.cures import Remedy, remedy_for_waits
from sim.diagnosis.edits.flags import enders, event_setters, setters, sleeps
from sim.diagnosis.rule import CodeLocation, Explanation, Finding, Rule, Weight, line_location, line_of
from sim.diagnosis.rules.edits import beside_others, edits_for_reply, edits_for_waiting
from sim.diagnosis.rules.unended import on_waits, unended
from sim.diagnosis.time_limits import ends_by_itself, goes_on
from sim.diagnosis.timeline_view import TimelineView
from sim.diagnosis.words import awaited_lock, listed, must_answer, often, threads_for, who
from sim.quantities.durations import duration
from sim.quantities.nanoseconds import SECOND
from sim.trace.descriptions import doing_of
from sim.trace.events import Doing, EntityId, EntityKind, GroupKind, Notice, NoticeKind, Severity
from sim.trace.model import RESULT, Position, Span, Window
from sim.trace.timeline import Timeline

_ADVICE = "wait with a timeout, and make sure that something ends the wait"
"""For notices without advice, as of waits on the real clock, and in old recordings."""
_WAITS = "a thread that waits serves nothing else, and without a timeout it may do so for ever"
_LEFT = "a lock stays taken when the thread ends that took it, until somebody releases it"
_RELEASE = "take the lock by with, which releases it on every way out"
_LET_GO = "let go of the lock before anything that takes long"
_KEPT = (
    "while {0} runs, no other callback of its group or thread does: if it waits for what one of them brings, "
    "that never comes"
)
_AWAITED = "while {0} runs, no other callback of its group or thread does, and it waits for what {1} sets"
_LEAVE = (
    "keep the state in self and return: {0} is called again; or do one step of the loop at each call of a "
    "timer"
)
_LEAVE_FOR_TIMER = (
    "keep the state in self and return: {0} begins a timer that does one step of the loop at each call"
)
"""For callbacks that may be called only once."""
_LEAVE_WITH_RESPONSE = "return the response from {0}, and do one step of the loop at each call of a timer"


class EndlessWait(Rule):
    """A callback waits without a timeout, and what it waits for does not come.

    On virtual time the engine sees what all threads of a program wait for: a deadlock is final. Any other
    wait, and on the real clock every one, is reported until the callback returns.
    """

    id = "endless-wait"
    summary = "a callback waits for a lock or an event that does not come"
    is_effect = True

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each wait that the engine reported."""
        for notice in on_waits(view.timeline):
            at = _positions_at(notice, view.timeline)
            if any(goes_on(each, view.timeline) for each in at) and not _is_deadlock(notice):
                continue
            if notice.kind is not NoticeKind.NO_PROGRESS or not _computes(notice, view):
                stuck, until = frozenset([notice.entity]), _until(notice, view)
                yield Finding(self, notice.t, until, notice.entity, event=notice, stuck=stuck)

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        notice = _notice_of(found)
        at = _positions_at(notice, timeline)
        how = "is in a deadlock" if _is_deadlock(notice) else "stands still"
        what = f" {how}: {notice.problem}" if notice.problem else f": {notice.text}"
        if notice.kind is NoticeKind.NO_PROGRESS and at:
            doing = f"waits for {awaited_lock(at[-1], timeline)}," if at[-1].lock else doing_of(at[-1])
            what = f" {doing} and {_how_long(found, timeline)}"
        place = line_location(*notice.place) or line_of(found.subject, _moment(found), timeline)
        kept = kept_waiting(found, timeline)
        ends = _enders(found.subject, at[-1] if at else None, timeline)
        what += f"; {listed(ends)} would end it" if ends else ""
        cure = "wait with a timeout, and make sure that it comes" if ends else notice.advice or _ADVICE
        if at and at[-1].taken_by and not notice.advice:
            cure = _RELEASE if at[-1].is_left else f"let {at[-1].taken_by} {_LET_GO}"
        room = remedy_for_waits(kept, found.subject, Window(found.at, found.until + 1), timeline)
        running = timeline.moment(found.until).running.values()
        calls = sum(each.entity == found.subject for each in running)
        if calls > 1:
            room = Remedy((found.subject,))
            one = f"then one of its calls waits at a time, and not {calls} on a thread each"
            cure += f"; give {who(found.subject, timeline)} a MutuallyExclusiveCallbackGroup: {one}"
        elif not _may_help(found, place, kept, at, timeline):
            room = Remedy()
        file, line = (at[-1].file, at[-1].line) if at else ("", 0)
        missing, instead, edits = unended(found.subject, file, line, timeline)
        if missing:
            what, cure, room = f"{what}; {missing}", instead, Remedy()
        if kept and (missing or room.words(timeline)):
            what += f"; {listed(who(each, timeline) for each in kept)} can run only when it is over"
        if room.words(timeline) and calls == 1:
            cure = f"{cure}: {room.words(timeline)}"
            if ends:
                cure = f"wait with a timeout; and {room.words(timeline)}, so that what ends the wait can run"
        return Explanation(
            f"{who(found.subject, timeline)}{what}{often(found.count)}",
            _LEFT if at and at[-1].is_left else _WAITS,
            cure,
            place,
            for_ever=found.until >= timeline.end,
            remedies=edits if missing else (room,) if kept else (),
        )

    def weigh(self, found: Finding, timeline: Timeline) -> Weight | None:
        """Irrelevant if the wait ended after all, be it by an exception that ended the run."""
        raised = any(span.error for span in timeline.spans_of(found.subject, _moment(found)))
        over = (found.until < timeline.end or raised) and not _is_deadlock(_notice_of(found))
        return None if over else Weight.PROBLEM


def _may_help(
    found: Finding,
    place: CodeLocation | None,
    kept: Sequence[EntityId],
    at: Sequence[Position],
    timeline: Timeline,
) -> bool:
    """Whether room helps: those that may end the wait have none, or are unknown.

    The result of a pool comes from its own threads.
    """
    functions = event_setters(place.file, place.first_line) if place else ()
    known = [each for each in timeline.entities.values() if each.spoken_name in functions]
    if not known:
        return bool(functions) or not at or at[-1].call != RESULT
    group = timeline.entities[found.subject].group
    is_alone = threads_for([found.subject], found.until, timeline) == 1
    is_exclusive = timeline.groups[group].kind is GroupKind.EXCLUSIVE
    return any(is_alone or each.id in kept or (is_exclusive and each.group == group) for each in known)


class StillComputing(Rule):
    """A callback has computed for long without a wait, and has not returned.

    The engine reports it after a while, also on virtual time, which stands still then. Whether it would ever
    return is unknown.
    """

    id = "still-computing"
    summary = "a callback computes and does not come back"
    hangs_from = 0
    is_effect = True

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each call that the engine reported."""
        for notice in on_waits(view.timeline):
            if notice.kind is NoticeKind.NO_PROGRESS and _computes(notice, view):
                stuck = frozenset([notice.entity])
                until = _until(notice, view)
                yield Finding(self, notice.t, until, notice.entity, notice.entity, event=notice, stuck=stuck)

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        subject = who(found.subject, timeline)
        at = _positions_at(_notice_of(found), timeline)
        loop = line_location(*at[-1].loop) if at else None
        place = loop or line_of(found.subject, _moment(found), timeline)
        where = f" in the loop of line {loop.first_line}" if loop else ""
        return Explanation(
            f"{subject} computes{where} and {_how_long(found, timeline)}",
            _why(found.subject, loop, timeline),
            _leaving(found.subject, loop, timeline),
            place,
            for_ever=found.until >= timeline.end,
            remedies=(
                *edits_for_waiting(place, found.subject, timeline),
                *edits_for_reply(place, found.subject, timeline),
            ),
        )

    def weigh(self, found: Finding, timeline: Timeline) -> Weight | None:
        """Irrelevant if it returned after all."""
        return self.weight if found.until >= timeline.end else None


class StaysInLoop(Rule):
    """A callback has been in a ``while`` for long that neither a clock nor a counter of its own ends.

    Whether something else ends it, such as another thread, is unknown. An action's ``execute`` may loop.
    """

    id = "stays-in-loop"
    summary = "a callback does not leave its loop"
    hangs_from = 3 * SECOND
    threshold = 3 * SECOND // 2
    is_effect = True

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each running call that was in one loop for all of the last seconds."""
        told = {notice.entity for notice in on_waits(view.timeline)}
        for span in view.now.running.values():
            since = _in_loop_since(span, view, self.threshold)
            if since is not None and span.entity not in {*told, *view.nested_spinners}:
                stuck = frozenset([span.entity])
                yield Finding(
                    self, since, view.end, span.entity, span.entity, stuck=stuck, size=view.end - since
                )

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        subject = who(found.subject, timeline)
        at = timeline.positions_of(found.subject, _moment(found))[-1]
        loop = line_location(*at.loop)
        kept = kept_waiting(found, timeline)
        room = remedy_for_waits(kept, found.subject, Window(found.at, found.until + 1), timeline)
        only = (
            f"; {listed(who(each, timeline) for each in kept)} can run only when it is over" if kept else ""
        )
        return Explanation(
            f"{subject} has been in the loop of line {at.loop[1]} for {duration(found.lasted)}{only}",
            _why(found.subject, loop, timeline),
            _leaving(found.subject, loop, timeline),
            loop,
            remedies=(*((room,) if kept else ()), *edits_for_waiting(loop, found.subject, timeline)),
        )

    def weigh(self, found: Finding, timeline: Timeline) -> Weight | None:
        """Irrelevant if it left the loop after all, a remark if it goes on there and keeps nobody waiting."""
        if found.until < timeline.end:
            return None
        at = timeline.positions_of(found.subject, Window(found.until, found.until + 1))
        is_worker = all(goes_on(each, timeline) for each in at) and not kept_waiting(found, timeline)
        return Weight.REMARK if is_worker else self.weight


def _in_loop_since(span: Span, view: TimelineView, least: int) -> int | None:
    """When a running call came to the loop that it has been in for so long; None if it has not."""
    entity = view.timeline.entities.get(span.entity)
    if entity is None or entity.kind is EntityKind.WAITABLE:
        return None
    lately = Window(view.end - least, view.end + 1)
    loops = {
        each.loop for each in view.timeline.positions_of(span.entity, lately) if each.thread == span.thread
    }
    loop = loops.pop() if len(loops) == 1 else ("", 0)
    if not loop[0] or ends_by_itself(*loop):
        return None
    all_of_it = view.timeline.positions_of(span.entity, Window(span.start, view.end + 1))
    since = next(each.start for each in all_of_it if each.loop == loop)
    return since if since <= lately.start else None


def kept_waiting(found: Finding, timeline: Timeline) -> list[EntityId]:
    """Return the callbacks that wait for a callback's group or thread at the end of its wait."""
    waiting = timeline.moment(found.until).waiting
    return [each for each, wait in waiting.items() if wait.holder == found.subject != each]


def _computes(notice: Notice, view: TimelineView) -> bool:
    return all(each.doing is not Doing.WAITS for each in _positions_at(notice, view.timeline))


def _why(entity: EntityId, loop: CodeLocation | None, timeline: Timeline) -> str:
    """Tell what a callback in a loop keeps from running."""
    subject, others = who(entity, timeline), _setters(entity, loop, timeline)
    return _AWAITED.format(subject, listed(others)) if others else _KEPT.format(subject)


def _leaving(entity: EntityId, loop: CodeLocation | None, timeline: Timeline) -> str:
    """Return the cure of a callback in a loop."""
    subject, others = who(entity, timeline), _setters(entity, loop, timeline)
    if others:
        room = beside_others(entity, timeline).words(timeline)
        is_asleep = loop is not None and sleeps(loop.file, loop.first_line)
        if must_answer(entity, timeline):
            return room if is_asleep else f"sleep() in the loop, and {room}"
        sleeping = "" if is_asleep else ", with a sleep() in the loop"
        inside = f"to wait inside {subject}{sleeping}, {room}"
        return f"return from {subject}, and go on in {listed(others)}; {inside}"
    text = _LEAVE if timeline.entities[entity].kind is EntityKind.TIMER else _LEAVE_FOR_TIMER
    if must_answer(entity, timeline):
        text = _LEAVE_WITH_RESPONSE
    return text.format(subject)


def _setters(entity: EntityId, loop: CodeLocation | None, timeline: Timeline) -> list[str]:
    """Return the other functions that set what the loop of a callback asks."""
    found = setters(loop.file, loop.first_line) if loop else ()
    return [each for each in found if each != who(entity, timeline)]


def _enders(entity: EntityId, at: Position | None, timeline: Timeline) -> list[str]:
    """Return the calls of other functions that end a callback's wait, as its source shows."""
    if at is None or at.doing is not Doing.WAITS or at.waits_for_lock:
        return []
    file, own = at.file, who(entity, timeline)
    return [
        f"{call}() in {function} ({Path(file).name}:{line}){_waiting_too(function, timeline)}"
        for function, call, line in enders(file, at.line)
        if function != own
    ]


def _waiting_too(function: str, timeline: Timeline) -> str:
    """Say that a callback which would end a wait stands in a wait itself; "" if it does not."""
    now = timeline.moment(timeline.end)
    stands = (timeline.position_on(thread, timeline.end) for thread in (*now.running, *now.blocked))
    waits = (each for each in stands if each is not None and each.doing in (Doing.WAITS, Doing.CALLS_ROS))
    known = timeline.entities
    at = next((each for each in waits if each.entity and known[each.entity].spoken_name == function), None)
    doing = "" if at is None else doing_of(at)
    where = "" if at is None else f"{Path(at.file).name}:{at.line}"
    return doing and f", which {'is' if doing.startswith('in ') else 'itself'} {doing} ({where}),"


def _moment(found: Finding) -> Window:
    return Window(found.at, found.at + 1)


def _notice_of(found: Finding) -> Notice:
    assert isinstance(found.event, Notice)
    return found.event


def _how_long(found: Finding, timeline: Timeline) -> str:
    """For how long a call has not come back: on virtual time, which may stand still, as the engine says."""
    spans = _calls_at(_notice_of(found), timeline)
    if spans and timeline.started is not None and timeline.started.clock == "real":
        return f"has not come back for {duration(found.until - spans[-1].start)}"
    return _notice_of(found).problem or "has not come back for long"


def _is_deadlock(notice: Notice) -> bool:
    """Whether the notice reports a deadlock; in recordings without kinds only these are errors."""
    return notice.kind is NoticeKind.DEADLOCK or notice.severity is Severity.ERROR


def _until(notice: Notice, view: TimelineView) -> int:
    """The end of the call, or wait, that a notice is about; now if it lasts."""
    calls = _calls_at(notice, view.timeline)
    until = max((view.end if call.end is None else call.end for call in calls), default=view.end)
    at = view.timeline.position_on(notice.thread, view.end) if notice.thread and until == view.end else None
    is_over = at is not None and not at.waits and not _computes(notice, view)
    return until if at is None or not is_over else at.start


def _calls_at(notice: Notice, timeline: Timeline) -> list[Span]:
    """Return the call that a notice is about, or all of its callback where the thread is unknown."""
    calls = timeline.spans_of(notice.entity, Window(notice.t, notice.t + 1))
    return [each for each in calls if notice.thread in (0, each.thread)]


def _positions_at(notice: Notice, timeline: Timeline) -> list[Position]:
    """Return where the call was that a notice is about, or where all of its callback were."""
    positions = timeline.positions_of(notice.entity, Window(notice.t, notice.t + 1))
    return [each for each in positions if notice.thread in (0, each.thread)]
