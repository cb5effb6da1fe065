"""What the narrator tells: the executor's decisions at a moment, and their reasons, for each callback."""

from collections.abc import Iterator, Sequence
from itertools import pairwise

from cbtui.widgets.lanes.names import short_thread
from sim.diagnosis.words import group_of, late_reply, thread_count
from sim.quantities.durations import duration, timestamp
from sim.trace.descriptions import name_of, why_waiting
from sim.trace.events import Doing, EntityId, EntityKind, Reason, ThreadId
from sim.trace.figures.waiting import (
    WORTH_TELLING,
    admits_others,
    had_other_reasons,
    is_held_by_own_call,
    just_due,
    next_in_turn,
    waits_at,
    waits_since,
)
from sim.trace.model import Blocked, Deed, EntityInfo, Moment, Nanoseconds, Span, Wait, Window
from sim.trace.timeline import Timeline

_ORDER = (
    EntityKind.TASK,
    EntityKind.WAITABLE,
    EntityKind.TIMER,
    EntityKind.SUBSCRIPTION,
    EntityKind.GUARD,
    EntityKind.CLIENT,
    EntityKind.SERVICE,
)
"""The order in which rclpy's executors examine the entities of a node."""
_IN_ORDER = {
    EntityKind.TASK: "tasks come first",
    EntityKind.WAITABLE: "waitables come first",
    EntityKind.TIMER: "timers come first",
    EntityKind.SUBSCRIPTION: "no timer is before it",
    EntityKind.GUARD: "neither timer nor subscription is before it",
    EntityKind.CLIENT: "neither timer nor subscription is before it",
    EntityKind.SERVICE: "services come last",
}

_MOVES = 0.001
"""The least speed in m/s or rad/s that is a movement: physics leaves less to a robot at rest."""


def narration(timeline: Timeline, at: Nanoseconds, stepped: bool = False) -> tuple[str, ...]:
    """Return the executor's last decisions by a moment, and the callbacks that still waited, in its order.

    If time was ``stepped`` to a moment without an action, return what else happens at that moment.
    """
    last = timeline.neighbour(at + 1, -1)
    if stepped and at > (last or 0):
        return _without_decision(timeline, at, last or 0)
    if last is None:
        return ("nothing has happened yet",)
    first, *more = _decided(timeline, last) or ("the executor looks again",)
    return (f"{timestamp(last)}: {first}", *more, *_waits(timeline, at, last))


def decisions_at(timeline: Timeline, at: Nanoseconds, stepped: bool = True) -> int:
    """Return with how many sentences ``narration`` tells what was decided at a moment; at least 1."""
    last = at if stepped else timeline.neighbour(at + 1, -1)
    return 1 if last is None else max(1, len(_decided(timeline, last)))


def decided_about(timeline: Timeline, at: Nanoseconds, place: int) -> tuple[EntityId, ThreadId | None] | None:
    """Return the callback and the thread, if any, that a decision of a moment is about.

    ``place`` counts from 0, -1 is the last.
    """
    about = [(entity, thread) for entity, thread, _ in _deeds(timeline, at)]
    return about[place] if -len(about) <= place < len(about) else None


def _decided(timeline: Timeline, at: Nanoseconds) -> Sequence[str]:
    """What was decided at a moment; who has become ready, if that is all, as it is told with the waits."""
    ready = [
        f"{name_of(wait.entity, timeline)} {_readied(wait, timeline)}"
        for wait in waits_at(timeline.moment(at), timeline)
        if wait.since == at
    ]
    return tuple(told for *_, told in _deeds(timeline, at)) or tuple(filter(None, ("; ".join(ready),)))


def _deeds(timeline: Timeline, at: Nanoseconds) -> Iterator[tuple[EntityId, ThreadId | None, str]]:
    """What was done at a moment, by whom and on which thread; calls without duration and losses once."""
    made = list(timeline.decisions(Window(at, at + 1)))
    at_once = [span for (_, span), then in pairwise(made) if then == (Deed.ENDED, span)]
    losses = iter(_lost(timeline, at))
    for deed, what in made:
        match what:
            case Span() if deed is Deed.SUSPENDED:
                yield what.entity, what.thread, _suspending(what, timeline)
            case Span() if deed is not Deed.ENDED:
                begun = _begun(what, deed, timeline, returns=what in at_once)
                yield from ((what.entity, what.thread, told) for told in begun)
            case Span() if what not in at_once:
                yield what.entity, what.thread, returning(what, timeline)
            case Blocked():
                yield what.entity, what.thread, _blocked(what, deed, timeline)
            case int():
                yield from ((what, None, told) for told in losses)


def _without_decision(timeline: Timeline, at: Nanoseconds, last: Nanoseconds) -> tuple[str, ...]:
    """Tell a moment at which the executor decided nothing: what else happened, or that only time passed.

    A live run stops at a moment before its threads go on, so what they did at the moment before is told, too.
    """
    moment = timeline.moment(at)
    then = "; ".join((*_sent(timeline, at), *_done(timeline, at), *_due(timeline, at)))
    present = (timeline.position_on(thread, at) for thread in timeline.threads)
    since = max((each.start for each in present if each and each.start > last), default=at)
    before = "; ".join(_done(timeline, since))
    first = f"time goes on to {timestamp(at)}"
    if then:
        first = f"{timestamp(at)}: {then}"
    elif before:
        first = f"{timestamp(since)}: {before}; then {first}"
    running = dict.fromkeys(
        name_of(span.entity, timeline)
        for thread, span in moment.running.items()
        if thread not in moment.blocked  # that it waits in its call is told below
    )
    robot = timeline.robot(at)
    goes_on = [f"{name} still runs" for name in running]
    if robot is not None and max(abs(robot.linear), abs(robot.angular)) >= _MOVES:
        goes_on.append(f"the robot still {'drives' if abs(robot.linear) >= _MOVES else 'turns'}")
    first = f"{first}: {', '.join(goes_on)}" if goes_on and not then else first
    return (first, *_waits(timeline, at, at))


def _waits(timeline: Timeline, at: Nanoseconds, since: Nanoseconds) -> Sequence[str]:
    """Who waits at a moment, and why; for its own last call only if nobody else waits, or from ``since``."""
    left = _left(timeline, at)
    moment = timeline.moment(at)
    turns = {**next_in_turn(moment, timeline), **dict.fromkeys(just_due(moment, timeline), at)}.items()
    told_too = [_turn(each, begun, timeline, at) for each, begun in turns if not left or begun >= since]
    calls = [
        late_reply(each, moment, timeline) or _in_its_call(each, timeline)
        for each in moment.blocked.values()
        if each.start < since
    ]
    told = (*_by_cause(left, timeline, at), "; ".join(told_too), *calls)
    return tuple(filter(None, told)) or (_at_rest(timeline, at),)


def _left(timeline: Timeline, at: Nanoseconds) -> list[Wait]:
    """The waits of a moment that others cause, in the order in which an executor examines who waits."""
    waits = (wait for wait in waits_at(timeline.moment(at), timeline) if not wait.is_for_own_call)
    return sorted(waits, key=lambda wait: _place(timeline.entities[wait.entity]))


def _sent(timeline: Timeline, at: Nanoseconds) -> Iterator[str]:
    """What was sent at a moment."""
    for call in timeline.calls_within(Window(max(0, at - 1), at + 1)):
        if call.replied == at:
            yield f"{call.service} replies"
        elif call.sent == at:
            yield f"{call.service} is called"
    services = {call.service for call in timeline.calls}
    for name in timeline.names_sent:
        if name not in services and any(each.at == at for each in timeline.sent_on(name)):
            yield f"a message is sent on {name}"


def _due(timeline: Timeline, at: Nanoseconds) -> Iterator[str]:
    """How many timers fall due at a moment."""
    if due := len(just_due(timeline.moment(at), timeline)):
        yield "a timer falls due" if due == 1 else f"{due} timers fall due"


def _done(timeline: Timeline, at: Nanoseconds) -> Iterator[str]:
    """Who has slept until a moment, and whether something is written to the log then."""
    for thread in timeline.threads:
        for each in timeline.positions_on(thread, Window(max(0, at - 1), at + 1)):
            if each.doing is Doing.SLEEPS and each.end == at:
                yield f"{name_of(each.entity, timeline)} has slept, and goes on"
    lines = timeline.logs_until(at) - timeline.logs_until(at - 1)
    if lines:
        yield "a line is written to the log" if lines == 1 else f"{lines} lines are written to the log"


def _place(entity: EntityInfo) -> tuple[int, int, EntityId]:
    """The place of an entity in the order in which an executor examines it."""
    return entity.node, _ORDER.index(entity.kind), entity.id


def returning(span: Span, timeline: Timeline) -> str:
    """Return the sentence on the end of a call, and what that frees."""
    name, group = name_of(span.entity, timeline), _exclusive_group(span.entity, timeline)
    lasted = duration(span.end_at(timeline.end) - span.start)
    if timeline.processes_ended.get(timeline.threads[span.thread].process) == span.end:
        return f"{name} does not return: its process ends, {lasted} after it began"
    freed = group or ("" if _around(span, timeline) else short_thread(timeline.threads[span.thread].name))
    if span.error:
        return f"{name} raises after {lasted}: {span.error}"
    return f"{name} returns after {lasted}{f', {freed} is free' if freed else ''}"


def _suspending(span: Span, timeline: Timeline) -> str:
    kept = _exclusive_group(span.entity, timeline)
    keeps = f", and keeps {kept} meanwhile" if kept else ""
    return f"{name_of(span.entity, timeline)} awaits, on no thread{keeps}"


def _exclusive_group(entity: EntityId, timeline: Timeline) -> str:
    """The group that a call of an entity holds; "" for one that admits others meanwhile, or is not asked."""
    is_held = _asks_groups(timeline) and not admits_others(entity, timeline)
    return group_of(entity, timeline) if is_held else ""


def _asks_groups(timeline: Timeline) -> bool:
    """Whether not every executor is an EventsExecutor, which asks no group."""
    kinds = {each.kind for each in timeline.executors.values()}
    return kinds != {"EventsExecutor"}


def _around(span: Span, timeline: Timeline) -> str:
    """The callback inside which a call runs, as by a nested spin; "" for none."""
    if not timeline.has_nested(span.thread):
        return ""
    made = list(timeline.decisions(Window(span.start, span.start + 1)))
    before = made[: [what for _, what in made].index(span)]
    over = [what for deed, what in before if deed in (Deed.ENDED, Deed.SUSPENDED)]
    beside = timeline.spans_on(span.thread, Window(max(0, span.start - 1), span.start + 1))
    around = [each for each in beside if each.number < span.number and each not in over]
    return name_of(around[-1].entity, timeline) if around else ""


def _blocked(blocked: Blocked, deed: Deed, timeline: Timeline) -> str:
    caller = name_of(blocked.entity, timeline) if blocked.entity else "the program"
    if deed is Deed.UNBLOCKED:
        return f"{caller} goes on after its call of {blocked.service}"
    group = " and its group" if blocked.entity and _exclusive_group(blocked.entity, timeline) else ""
    return f"{caller} calls {blocked.service}, and keeps its thread{group} until the reply"


def _in_its_call(blocked: Blocked, timeline: Timeline) -> str:
    caller = name_of(blocked.entity, timeline) if blocked.entity else "the program"
    return f"{caller} has waited in its call of {blocked.service} since {timestamp(blocked.start)}"


def _lost(timeline: Timeline, at: Nanoseconds) -> Sequence[str]:
    """What was lost at a moment, and before it since anything else happened."""
    before = timeline.neighbour(at + 1, -1, losses=False)
    since = at if before == at else 0 if before is None else before + 1
    losses = []
    for entity in timeline.entities.values():
        lost = timeline.losses_of(entity.id, Window(since, at + 1))
        if len(lost) == 1:
            losses.append(f"the full queue of {entity.spoken_name} loses its oldest message")
        elif lost:
            many, in_all = len(lost), timeline.drops_of(entity.id, Window(0, at + 1))
            more = f", {in_all} in all" if in_all > many else ""
            begun = timestamp(lost[0])
            losses.append(f"the full queue of {entity.spoken_name} has lost {many} since {begun}{more}")
    return ["; ".join(losses)] if losses else []


def _begun(span: Span, deed: Deed, timeline: Timeline, *, returns: bool) -> Iterator[str]:
    entity = timeline.entities.get(span.entity)
    if entity is None:
        return
    thread, around = short_thread(timeline.threads[span.thread].name), _around(span, timeline)
    is_free = f"{thread} spins inside {around}" if around else f"{thread} is free"
    end = f", and {f'raises at once: {span.error}' if span.error else 'returns at once'}" if returns else ""
    if deed is Deed.RESUMED:
        yield f"{is_free}: {entity.spoken_name} goes on after its await{end}"
        return
    reasons = [
        f"{is_free}: {entity.spoken_name} {_readiness(entity, span)}",
        *_why_first(entity, [*_left(timeline, span.start), *_passed_over(span, timeline)], timeline),
    ]
    if _asks_groups(timeline):
        reasons.append(f"{group_of(entity.id, timeline)} lets it in")
    yield f"{', '.join(reasons)} → runs{end}"


def _readiness(entity: EntityInfo, span: Span) -> str:
    match entity.kind:
        case EntityKind.TIMER:
            return f"is due, {duration(span.age)} late" if span.age > 0 else "is due"
        case EntityKind.SUBSCRIPTION:
            return f"has a message, {duration(span.age)} old" if span.age > 0 else "has a message"
        case EntityKind.SERVICE:
            return "has a request"
        case EntityKind.CLIENT:
            return "is there"
    return "is ready"


def _why_first(entity: EntityInfo, left: Sequence[Wait], timeline: Timeline) -> Iterator[str]:
    """Why an entity was chosen: the others lack a thread, or come after it in the order."""
    if any(wait.reason is Reason.EVENT_QUEUE for wait in left):
        yield "it came first"
    others = [
        timeline.entities[wait.entity]
        for wait in left
        if (wait.reason is Reason.NO_FREE_WORKER or wait.is_for_own_call) and wait.entity != entity.id
    ]
    if others:
        is_first = all(_place(entity) < _place(other) for other in others)
        yield _IN_ORDER[entity.kind] if is_first else "it was ready when the executor last looked"


def _passed_over(span: Span, timeline: Timeline) -> Iterator[Wait]:
    """The waits of those that were ready before a call began and whose turn on its thread came at once after.

    What waited for its own last call had only the turn to wait for, once that was over.
    """
    at = Window(max(0, span.start - 1), span.start + 1)
    calls = (each for each in timeline.spans_on(span.thread, at) if each.start == span.start)
    for entity in {each.entity for each in calls if each.number > span.number}:
        yield from (each for each in timeline.waits_of(entity, at) if each.end == span.start)


def _by_cause(left: Sequence[Wait], timeline: Timeline, at: Nanoseconds) -> Iterator[str]:
    """Say of each cause who waits for it."""
    causes: dict[str, list[Wait]] = {}
    for wait in left:
        causes.setdefault(_why(wait, timeline), []).append(wait)
    for why, waits in causes.items():
        if len(waits) == 1:
            yield waiting(waits[0], timeline, at)
        else:
            now = "now " if any(_had_others(wait, timeline, at) for wait in waits) else ""
            yield f"{now}{why}: {'; '.join(_how_long(wait, timeline, at) for wait in waits)}"


def waiting(wait: Wait, timeline: Timeline, at: Nanoseconds, begins: str = "is ready") -> str:
    """Return why a callback that is ready does not run at a moment; ``begins`` is said of a short wait."""
    now = ", now" if _had_others(wait, timeline, at) else ""
    return f"{_how_long(wait, timeline, at, begins)}{now}: {_why(wait, timeline)}"


def _had_others(wait: Wait, timeline: Timeline, at: Nanoseconds) -> bool:
    since = waits_since(wait, timeline.queue(wait.entity, at), timeline)
    return had_other_reasons(wait, since, at, timeline)


def _how_long(wait: Wait, timeline: Timeline, at: Nanoseconds, begins: str = "is ready") -> str:
    entity = timeline.entities[wait.entity]
    queue = timeline.queue(entity.id, at)
    since = waits_since(wait, queue, timeline)
    waits = begins if at - since < WORTH_TELLING else f"has waited since {timestamp(since)}"
    ready = f", {queue.depth} queued" if queue.depth else ", due" if entity.kind is EntityKind.TIMER else ""
    return f"{entity.spoken_name} {waits}{ready}"


def _why(wait: Wait, timeline: Timeline) -> str:
    match wait.reason:
        case Reason.GROUP_HELD:
            return why_waiting(wait, timeline)
        case Reason.NO_FREE_WORKER:
            return f"{group_of(wait.entity, timeline)} would let it in, but no thread is free"
        case Reason.EVENT_QUEUE:
            return "others came before it, and its EventsExecutor asks no group"
        case Reason.NOBODY_SPINS:
            return "nobody spins its node"


def _readied(wait: Wait, timeline: Timeline) -> str:
    if not wait.is_for_own_call:
        return "is ready"
    return "is due again" if timeline.entities[wait.entity].kind is EntityKind.TIMER else "is ready again"


def _turn(each: EntityId, since: Nanoseconds, timeline: Timeline, at: Nanoseconds) -> str:
    """Say what a callback that waits for no other one is to take, and when."""
    entity, moment = timeline.entities[each], timeline.moment(at)
    queued, waited = moment.queues[entity.id].depth, moment.at - since
    is_own = is_held_by_own_call(each, moment, timeline)
    is_ready = f"has {queued} queued" if queued else f"is due{' again' if is_own else ''}"
    if each in moment.waiting and not queued:
        is_ready = _readied(moment.waiting[each], timeline)
    is_ready = "is there" if entity.kind is EntityKind.CLIENT and queued == 1 else is_ready
    lasted = f"{', the next' if queued else ''} for {duration(waited)}" if waited else ""
    holders = () if admits_others(each, timeline) else moment.holders.get(entity.group, ())
    when = "it is free to run"
    if is_own:
        when = "its last call still runs"
    elif holders and _asks_groups(timeline):
        when = f"{group_of(each, timeline)} held by {name_of(holders[0], timeline)}"
    elif moment.running and not _idle(moment, timeline):
        when = "no thread is free"
    return f"{entity.spoken_name} {is_ready}{lasted}: {when}"


def _idle(moment: Moment, timeline: Timeline) -> int:
    """The number of the executors' threads that run nothing at a moment."""
    return max(0, thread_count(timeline) - len(moment.running))


def _at_rest(timeline: Timeline, at: Nanoseconds) -> str:
    moment = timeline.moment(at)
    idle, busy = _idle(moment, timeline), len(moment.running)
    if not idle:
        return "nothing else is ready"
    threads, verb = idle + busy, "is" if idle == 1 else "are"
    everybody = {1: "the only thread", 2: "both threads"}.get(threads, f"all {threads} threads")
    if busy:
        return f"nothing else is ready: {idle} of {threads} threads {verb} idle"
    return f"nothing is ready: {everybody} {verb} idle"
