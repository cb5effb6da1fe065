"""Rules on callbacks that wait for replies which cannot come while they wait."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

from sim.diagnosis.cures import Remedy
from sim.diagnosis.deadlock_search import deadlocks, recursive_services
from sim.diagnosis.edits.locks import (
    keeps_lock,
    let_go_during_wait,
    make_one,
    make_reentrant,
    release_during_wait,
    take_before,
    take_by_one_with,
    take_by_with,
    take_early,
    take_together,
)
from sim.diagnosis.edits.program_file import asked_of_file
from sim.diagnosis.edits.replies import decides_on_parameters
from sim.diagnosis.edits.timers import destroy_rate, keeps_rate
from sim.diagnosis.rule import (
    CodeLocation,
    Explanation,
    Finding,
    Rule,
    WaitedFor,
    by_edit,
    entity_of,
    is_models,
    line_of,
    place_of,
)
from sim.diagnosis.rules.edits import edits_for_reply, edits_for_rounds, edits_for_steps
from sim.diagnosis.timeline_view import TimelineView
from sim.diagnosis.waiters import StuckCallback
from sim.diagnosis.words import (
    awaiting,
    listed,
    must_answer,
    often,
    thread_of,
    threads_for,
    until_when,
    who,
    with_threads,
)
from sim.trace.events import EntityId, EntityKind, GroupKind
from sim.trace.model import AWAIT, Nanoseconds, Window
from sim.trace.timeline import Timeline


class SelfMadeDeadlock(Rule):
    """Callbacks wait for each other in a cycle, often one for itself.

    The usual case is ``Client.call`` inside a callback of the client's own exclusive group, or with the only
    thread there is. Source: the ROS 2 how-to guide "Synchronous vs. asynchronous service clients".
    """

    id = "self-made-deadlock"
    summary = "callbacks wait for each other, or one for a reply that it keeps from coming"
    hangs_from = 0

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each cycle."""
        return (
            _found(self, deadlock, until, stuck, view.timeline)
            for deadlock, until, stuck in deadlocks(view)
            if not _lacks_worker(deadlock)
        )

    def kind(self, found: Finding, timeline: Timeline) -> str:
        """Distinguish deadlocks over locks, rates and clocks from those over calls, and calls in services."""
        in_service = entity_of(found, timeline).kind is EntityKind.SERVICE
        over_call = "deadlock-in-a-service" if in_service else self.id
        return next((kind for wanted, kind in _KINDS.items() if wanted in found.waited_for), over_call)

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        subject = who(found.subject, timeline)
        both = _need_own_groups(found, timeline)
        apart = Remedy(both).words(timeline) or "keep it"
        stands = timeline.positions_of(found.subject, Window(found.at, found.until + 1))
        about = _OWN_LOCK if found.about == WaitedFor.LOCK and found.size == 1 else found.about
        if about == _OWN_LOCK and stands[-1].keeper:
            about = _LEFT_LOCK
        if found.waited_for >= {WaitedFor.LOCK, WaitedFor.REPLY}:
            there = timeline.positions_of(found.culprit, Window(found.at, found.until + 1))
            about = _LOCK_AND_AWAIT if any(each.call == AWAIT for each in there) else _LOCK_AND_CALL
        why, cure = _WHY.get(about, _WHY_REPLY), _CURES.get(about, "")
        if about == WaitedFor.RATE:
            keep = apart if _shares_group(found.subject, timeline) else "keep it"
            cure = f"remove sleep(), and have a timer of its period do one step at each call; or {keep}"
            is_kept = keeps_rate(stands[-1].file, stands[-1].line)
            cure += f", let {subject} end with destroy_rate()" if is_kept else ""
        elif about == WaitedFor.CLOCK:
            cure = f"return, and let a timer of the node's clock do what comes later; or {apart}"
        elif about in (WaitedFor.THREAD, WaitedFor.JOB):
            call, other = ("join", "thread") if about == WaitedFor.THREAD else ("result", "job")
            cure = f"return from {subject} without {call}(), and let the {other} do what comes later"
            cure += f"; or {apart}"
        awaits = bool(stands) and stands[-1].call == AWAIT
        answers = must_answer(found.subject, timeline)
        if awaits:
            later = f"return from {subject} and go on in future.add_done_callback(), or "
            cure = apart if answers else later + apart
            if _keeps_lock(stands[-1].file, stands[-1].line):
                cure = f"let go of the lock before the await, and {apart}"
        cure = apart if len(both) > 1 else cure or _outside_parameters(found, apart, timeline)
        if not cure and answers:
            later = awaiting(found.subject, timeline).replace("the future", "the future of call_async()", 1)
            cure = f"{apart} and let it wait as it does, or {later}"
        if not cure:
            # Where in a busy loop a thread was seen, in a call or between, is chance.
            computes = bool(stands) and not stands[-1].call and not stands[-1].loop[0]
            if not stands or computes or stands[-1].call == "Client.call":
                cure = f"use call_async() and return from {subject}, or {apart}"
            else:
                cure = (
                    f"return from {subject} and go on in future.add_done_callback(), or "
                    f"{awaiting(found.subject, timeline)}; to wait inside it, {apart}"
                )
        threads = 0
        if not awaits and WaitedFor.LOCK not in found.waited_for and _keeps_every_thread(found, timeline):
            threads = found.size + 1
            cure += f", and spin with {with_threads(threads)}"
        return _explanation(found, why, cure, self._remedies(found, threads, timeline), timeline)

    def _remedies(self, found: Finding, threads: int, timeline: Timeline) -> tuple[Remedy, ...]:
        place = _line_of(found.subject, found, timeline)
        both = _need_own_groups(found, timeline)
        apart = Remedy(both, threads)
        if found.about == WaitedFor.RATE:
            room = apart if _shares_group(found.subject, timeline) else Remedy(threads=threads)
            kept = by_edit(place, f"let {who(found.subject, timeline)} end with destroy_rate()", destroy_rate)
            is_kept = place is not None and keeps_rate(place.file, place.first_line)
            rooms = tuple(replace(room, edit=each.edit) for each in kept) if is_kept else (room,)
            return *_without_rate(place, found.subject, timeline), *rooms
        if found.about == WaitedFor.CLOCK:
            return *edits_for_steps(place, found.subject, timeline), apart
        if WaitedFor.LOCK not in found.waited_for:
            held = (replace(apart, edit=each.edit) for each in _letting_go(place))
            edits = edits_for_reply(place, found.subject, timeline)
            return apart, *(replace(each, own_groups=both[1:]) for each in edits), *held
        if WaitedFor.REPLY in found.waited_for:
            lines = _lines_of((found.subject, found.culprit), found, timeline)
            return tuple(each for line in lines for each in _letting_go(line))
        return _lock_remedies(place, found, timeline)


class NeedsOneMoreWorker(Rule):
    """Every worker of an executor is blocked in a call, and the reply needs one more.

    With K callbacks in ``Client.call`` at once, an executor needs at least K + 1 threads.
    """

    id = "needs-one-more-worker"
    summary = "all threads stand still in calls whose answers need a thread"
    hangs_from = 0

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each set of callbacks that block all threads of an executor."""
        return (
            _found(self, deadlock, until, stuck, view.timeline)
            for deadlock, until, stuck in deadlocks(view)
            if _lacks_worker(deadlock)
        )

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        why = f"{found.size} callbacks in call() at once need at least {found.size + 1} threads"
        room = Remedy(threads=found.size + 1)
        if found.keeper:
            why = f"{why}, and what answers them a group that lets it in"
            room = replace(room, own_groups=(found.keeper,))
        other = "use call_async()"
        if must_answer(found.subject, timeline):
            other = f"after call_async() {awaiting(found.subject, timeline)}"
        cure = f"{room.words(timeline)}, or {other}"
        place = _line_of(found.subject, found, timeline)
        edits = edits_for_reply(place, found.subject, timeline)
        return _explanation(found, why, cure, (room, *edits), timeline)


_KINDS = {
    WaitedFor.LOCK: "deadlock-over-a-lock",
    WaitedFor.RATE: "deadlock-over-a-rate",
    WaitedFor.CLOCK: "deadlock-over-the-clock",
}
_WHY_REPLY = "the executor brings request and reply, and each needs a group that lets it in and a thread"
_OWN_LOCK = "its own lock"
_LEFT_LOCK = "a lock that was left"
_LOCK_AND_CALL = "a lock and a reply"
_LOCK_AND_AWAIT = "a lock and an awaited reply"
_WHY = {
    _OWN_LOCK: "it holds the lock already, and a Lock cannot be taken twice",
    _LEFT_LOCK: "a lock stays taken when the call is over that took it, until somebody releases it",
    WaitedFor.RATE: "the rate's sleep() ends when the executor calls its timer, which needs a thread",
    WaitedFor.CLOCK: (
        "simulated time goes on when the executor takes the messages of /clock, which needs a group that "
        "lets it in and a thread"
    ),
    WaitedFor.FUTURE: "a callback keeps its group while it awaits, and what completes the future needs it",
    WaitedFor.THREAD: "the thread waits for what comes only once the callback that joins it has returned",
    WaitedFor.JOB: "the job waits for what comes only once the callback that wants its result has returned",
    WaitedFor.LOCK: "each keeps its lock while it waits for the other's, so neither lets go",
    _LOCK_AND_CALL: "the lock is held during a call, and whoever has to answer needs it",
    _LOCK_AND_AWAIT: "the lock is held during an await, and whoever has to answer needs it",
}
_CURES = {
    _OWN_LOCK: "take it once, let go of it before, or use threading.RLock",
    _LEFT_LOCK: "take the lock by with, which releases it on every way out",
    WaitedFor.LOCK: "take locks in the same order everywhere, and let go of one before you take the next",
    _LOCK_AND_CALL: "let go of the lock before the call, and take it again when the reply is there",
    _LOCK_AND_AWAIT: "let go of the lock before the await, and take it again when the reply is there",
}
_TELL_WHO_WAITS = (WaitedFor.LOCK, WaitedFor.THREAD, WaitedFor.JOB)
"""Where the first obstacle names who waits, and for what."""


_keeps_lock = asked_of_file(keeps_lock)


def _letting_go(place: CodeLocation | None) -> tuple[Remedy, ...]:
    words = "let go of the lock during the call"
    return *by_edit(place, words, let_go_during_wait), *by_edit(place, words, release_during_wait)


def _lock_remedies(place: CodeLocation | None, found: Finding, timeline: Timeline) -> tuple[Remedy, ...]:
    """Return edits of a callback that waits for its own lock, or for that of one that waits for its."""
    if found.size == 1:
        words = "take the lock by with, which releases it whatever happens"
        stands = timeline.positions_of(found.subject, Window(found.at, found.until + 1))
        taker = place_of(stands[-1].keeper, timeline)
        if taker is not None:
            lines = range(taker.first_line, taker.last_line + 1)
            places = (CodeLocation(taker.file, line, line) for line in lines)
            return tuple(each for there in places for each in by_edit(there, words, take_by_with))
        before = stands[-1].frames[-2:][0].line if stands else 0
        reentrant = by_edit(place, "make the lock a threading.RLock", make_reentrant, before)
        return *reentrant, *by_edit(place, words, take_by_with)
    other = _line_of(found.culprit, found, timeline)
    if place is None or other is None:
        return ()
    order = f"in the order of {who(found.culprit, timeline)}"
    positions = timeline.positions_of(found.subject, Window(found.at, found.until + 1))
    there = (each.frames for each in positions if (each.file, each.line) == (place.file, place.first_line))
    callers = (each.line for each in next(there, ())[:-1] if each.file == place.file)
    early = f"take both locks at once, {order}, one of them as a threading.RLock"
    return (
        *by_edit(place, f"take both locks at once, {order}", take_together, other.first_line),
        *by_edit(place, f"take both locks {order}", take_before, other.first_line),
        *by_edit(place, f"take both locks by one with, {order}", take_by_one_with, other.first_line),
        *by_edit(place, early, take_early, other.first_line, *callers),
        *by_edit(place, "make both locks one, a threading.RLock", make_one, other.first_line),
    )


def _without_rate(place: CodeLocation | None, entity: EntityId, timeline: Timeline) -> tuple[Remedy, ...]:
    """Return edits of a callback that sleeps by a rate at a place: its timer has the pace of the rate."""
    known, others = timeline.entities[entity], timeline.entities.values()
    rates = [each.period for each in others if each.node == known.node and each.period and is_models(each)]
    steps = edits_for_steps(place, entity, timeline)
    if not known.period or not rates:
        return steps
    least = -(-known.period // min(rates))
    return *steps, *edits_for_rounds(place, entity, timeline, least)


def _keeps_every_thread(found: Finding, timeline: Timeline) -> bool:
    """Whether stuck callbacks keep all threads of the executor: then a group of its own is not enough."""
    threads = [thread_of(each, found.until, timeline) for each in found.stuck]
    mine = thread_of(found.subject, found.until, timeline)
    kept = {each.id for each in threads if each and mine and each.executor == mine.executor}
    return len(kept) >= threads_for([found.subject], found.until, timeline)


def _need_own_groups(found: Finding, timeline: Timeline) -> tuple[EntityId, ...]:
    """Return the subject, and the other callback of a cycle if it keeps its own reply from coming as well.

    A task is in no group.
    """
    entities = timeline.entities
    return tuple(each for each in _in_the_way(found, timeline) if entities[each].kind is not EntityKind.TASK)


def _in_the_way(found: Finding, timeline: Timeline) -> tuple[EntityId, ...]:
    other = timeline.entities.get(found.culprit)
    blocked = timeline.moment(found.until - 1).blocked.values()
    services = {each.service for each in blocked if other is not None and each.entity == other.id}
    if other is None or other.id == found.subject or WaitedFor.LOCK in found.waited_for:
        return (found.subject,)
    keeps = any(
        each.kind is EntityKind.CLIENT and each.name in services and each.node == other.node
        for each in timeline.group_members(other.group)
    )
    is_exclusive = timeline.groups[other.group].kind is GroupKind.EXCLUSIVE
    return (found.subject, other.id) if keeps and is_exclusive else (found.subject,)


def _outside_parameters(found: Finding, apart: str, timeline: Timeline) -> str:
    """Return the cure of a callback that accepts parameters and asks a service about them; "" for others."""
    place = _line_of(found.subject, found, timeline)
    if place is None or not decides_on_parameters(place.file, place.first_line):
        return ""
    return f"ask by call_async() in a callback of add_post_set_parameters_callback(), or {apart}"


def _shares_group(entity: EntityId, timeline: Timeline) -> bool:
    return len(timeline.group_members(timeline.entities[entity].group)) > 1


def _line_of(entity: EntityId, found: Finding, timeline: Timeline) -> CodeLocation | None:
    return line_of(entity, Window(found.at, found.until + 1), timeline)


def _lines_of(entities: Sequence[EntityId], found: Finding, timeline: Timeline) -> Iterator[CodeLocation]:
    """Yield every line at which callbacks were meanwhile: several calls of one may be at different lines."""
    window = Window(found.at, found.until + 1)
    places = (each for entity in entities for each in timeline.positions_of(entity, window))
    for file, line in dict.fromkeys((each.file, each.line) for each in places):
        yield CodeLocation(file, line, line)


def _explanation(
    found: Finding, why: str, cure: str, remedies: tuple[Remedy, ...], timeline: Timeline
) -> Explanation:
    if ring := recursive_services(found.subject, found.until, timeline):
        (name, *others), remedies = [who(each, timeline) for each in ring], ()
        why, cure = f"{name} calls its own service", f"let {name} call itself as a function"
        if others:
            service, every = timeline.entities[ring[0]].name, listed([name, *others])
            why = f"{service} is called from within itself, by way of {listed(others)}"
            cure = f"let {others[-1]} call {name} as a function"
            if found.keeper:
                cure += f"; or, if the calls end by themselves, give {every} a ReentrantCallbackGroup each"
        why += ", and each such call keeps a thread until the next one is over"
        cure += "; no number of threads is enough for every depth"
    subject, wanted, lasts = who(found.subject, timeline), found.ring[1], found.until >= timeline.end
    until = until_when(found.ends, timeline)
    if found.about in _TELL_WHO_WAITS:
        waits = f"in vain{until}: " if found.ends or not lasts else "deadlock: "
    elif not lasts:
        waits = f"{subject} waited in vain for {wanted}; "
    elif found.ends:
        waits = f"{subject} waits in vain for {wanted}{until}; "
    else:
        waits = f"deadlock: {subject} waits for {wanted} for ever; "
    return Explanation(
        f"{waits}{found.detail}{often(found.count)}",
        why,
        cure,
        _line_of(found.subject, found, timeline),
        for_ever=lasts and not found.ends,
        until=found.ends if lasts else 0,
        remedies=remedies,
    )


def _lacks_worker(deadlock: Sequence[StuckCallback]) -> bool:
    return any(each.obstacle.needs_worker and len(each.obstacle.by) > 1 for each in deadlock)


def _found(
    rule: Rule,
    deadlock: Sequence[StuckCallback],
    until: Nanoseconds,
    stuck: frozenset[EntityId],
    timeline: Timeline,
) -> Finding:
    closing = deadlock[0]
    clauses: dict[object, str] = {}
    for obstacle in (each.obstacle for each in deadlock):
        # A request and a reply of one service that need a thread of the same ones are told once.
        key = (obstacle.wanted, obstacle.by) if obstacle.needs_worker else obstacle.text
        clauses.setdefault(key, obstacle.text)
    detail = "; ".join(dict.fromkeys(clauses.values()))
    callbacks = [each.entity for each in deadlock if each.entity]
    others = [each for each in callbacks if each != closing.entity]
    culprit = others[0] if others else closing.entity
    names = {each.waiter: each.entity for each in deadlock}
    keepers = (names[waiter] for each in deadlock if each.obstacle.group for waiter in each.obstacle.by)
    ring = (step for each in deadlock for step in (each.name(timeline), *each.obstacle.steps))
    return Finding(
        rule,
        closing.since,
        until,
        closing.entity,
        culprit,
        about=closing.obstacle.wanted,
        size=len(callbacks),
        detail=detail,
        stuck=stuck,
        ends=min((each.until for each in deadlock if each.until), default=0),
        waited_for=frozenset(each.obstacle.kind for each in deadlock),
        ring=(*ring, who(closing.entity, timeline)),
        keeper=next(keepers, 0),
        closed=max(max(each.since, each.obstacle.since) for each in deadlock),
    )
