"""Describes a selected bar: its cause, how long it waited, and for what."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from cbtui.widgets.lanes.keys import USUAL_KEYS, LaneKeys
from cbtui.widgets.lanes.names import short_thread
from cbtui.widgets.lanes.rows import GroupLane, MemberLane, ServiceLane, SoleLane, ThreadLane
from cbtui.widgets.lanes.selection import Bar, Selection, end_of, start_of
from sim.diagnosis.words import awaited_lock
from sim.quantities.durations import duration, timestamp
from sim.trace.descriptions import called_by, doing_of, name_of, why_waiting
from sim.trace.events import EntityId, EntityKind, Reason
from sim.trace.figures.waiting import WORTH_TELLING, wait_judged, waited_by, waits_since
from sim.trace.model import Call, EntityInfo, Nanoseconds, Position, Span, Wait, Window
from sim.trace.timeline import Timeline

_FIRST_REACH: Nanoseconds = 1_000_000
_MOST_REASONS = 2


@dataclass(frozen=True, slots=True)
class BarDetails:
    """A bar's title and the facts about it, the most important first."""

    title: str
    facts: tuple[str, ...] = ()


def details_of(timeline: Timeline, bar: Bar, now: Nanoseconds) -> BarDetails:
    """Describe a bar at the moment ``now``; open intervals end there. A later bar is told as it will be."""
    begins = start_of(bar)
    if begins > now:
        later = details_of(timeline, bar, end_of(bar) or timeline.end)
        return BarDetails(later.title, (f"begins later, at {timestamp(begins)}", *later.facts))
    match bar:
        case Span():
            return BarDetails(_who_runs(timeline, bar), tuple(_of_span(timeline, bar, now)))
        case Wait():
            bar = wait_judged(bar, timeline.moment(now), timeline)
            return BarDetails(_who_waits(timeline, bar, now), tuple(_of_wait(timeline, bar, now)))
        case Call():
            return BarDetails(f"call of {bar.service}", tuple(_of_call(timeline, bar, now)))


def details_of_selection(
    timeline: Timeline, selection: Selection, now: Nanoseconds, keys: LaneKeys = USUAL_KEYS
) -> BarDetails:
    """Describe a selection; for a lane without a bar, name the keys that find one."""
    if selection.bar is not None:
        return details_of(timeline, selection.bar, now)
    match selection.lane:
        case ThreadLane(thread):
            name = thread.name
        case GroupLane(group):
            name = f"group {group.letter}"
        case MemberLane(entity) | SoleLane(entity):
            name = entity.spoken_name
        case ServiceLane(service):
            name = service
    how = f"{keys.before} and {keys.after} go to what came before and after"
    return BarDetails(name, ("nothing up to here on screen", how))


# a call of a callback


def _who_runs(timeline: Timeline, span: Span) -> str:
    thread = timeline.threads.get(span.thread)
    where = "" if thread is None else f" on {short_thread(thread.name)}"
    return f"{_with_letter(timeline, span.entity)}{where}"


def _of_span(timeline: Timeline, span: Span, now: Nanoseconds) -> Iterator[str]:
    if span.end is None or span.end > now:
        took = _of_all(now - span.start, span, timeline)
        yield f"has run since {timestamp(span.start)}, for {took}"
    else:
        yield f"took {duration(span.end - span.start)} at {timestamp(span.start)}"
    if span.error:
        yield f"raised {span.error}"
    position = position_in(timeline, span, now)
    if position is not None:
        yield _at_line(timeline, span, now, position)
    yield from _blocked(timeline, span, now)
    waits = _waits_before(timeline, span)
    if waits:
        waited = waited_by(span.start, waits[-1], timeline)
        reasons = _reasons(timeline, [wait for wait in waits if wait.end_at(now) > span.start - waited])
        yield f"waited {duration(waited)}" + (f": {reasons}" if reasons else "")
    entity = timeline.entities.get(span.entity)
    if entity is not None:
        yield from _cause(timeline, span, entity)


def position_in(timeline: Timeline, span: Span, now: Nanoseconds) -> Position | None:
    """Where a call is in its code at ``now``; of one that is over, where it was longest."""
    until = timeline.end if span.end is None else span.end
    if span.start <= now and (now < until or span.end is None):
        return timeline.position_on(span.thread, now)
    inside = _positions_in(timeline, span, until)
    return max(inside, key=lambda each: (each.end or until) - each.start, default=None)


def _at_line(timeline: Timeline, span: Span, now: Nanoseconds, position: Position) -> str:
    """What a call does at its line; of one that is over, how much of its time it waited there.

    A wait in ``Client.call`` is left out: ``_blocked`` has it.
    """
    at = f"at {Path(position.file).name}:{position.line}"
    is_known = position.waits_for_lock and position.taken_at[0]
    does = f"waits {at} for {awaited_lock(position, timeline)}" if is_known else f"{doing_of(position)} {at}"
    end = span.end
    if end is None or span.start <= now < end or not position.waits or position.call == "Client.call":
        return does
    waited = duration(time_waited(timeline, span, position))
    return f"{waited} of it {does.replace('waits', 'waiting', 1)}"


def time_waited(timeline: Timeline, span: Span, there: Position | None = None) -> Nanoseconds:
    """For how long a call that is over waited, at one line or at all."""
    end = span.end_at(timeline.end)
    positions = [each for each in _positions_in(timeline, span, end) if each.waits]
    shown = [each for each in positions if there is None or each.frames == there.frames]
    return sum(min(each.end_at(end), end) - max(each.start, span.start) for each in shown)


def _positions_in(timeline: Timeline, span: Span, until: Nanoseconds) -> list[Position]:
    positions = timeline.positions_of(span.entity, Window(span.start, until))
    return [each for each in positions if each.thread == span.thread]


def _blocked(timeline: Timeline, span: Span, now: Nanoseconds) -> Iterator[str]:
    until = now if span.end is None else span.end
    for blocked in timeline.blocks_on(span.thread, Window(span.start, max(until, span.start + 1))):
        if blocked.entity == span.entity:
            lasted = (until if blocked.end is None else blocked.end) - blocked.start
            yield f"stood {duration(max(0, lasted))} in call {blocked.service}"


def _cause(timeline: Timeline, span: Span, entity: EntityInfo) -> Iterator[str]:
    """Return what made it ready: a period, a message and its publisher, or a request and its caller."""
    match entity.kind:
        case EntityKind.TIMER:
            yield f"due every {duration(entity.period)}, {_lateness(span.age)}"
        case EntityKind.SUBSCRIPTION:
            yield f"message {duration(span.age)} old, {_publisher(timeline, span, entity)}"
        case EntityKind.SERVICE:
            call = _call(timeline, span)
            if call is None:
                yield f"request {duration(span.age)} old"
            else:
                yield f"request {duration(span.start - call.sent)} old, {called_by(call, timeline)}"


def _lateness(age: Nanoseconds) -> str:
    return f"called {duration(age)} late" if age > 0 else "called on time"


def _publisher(timeline: Timeline, span: Span, entity: EntityInfo) -> str:
    on = f"on {entity.name}"
    publication = timeline.publication(span.message)
    if publication is None:
        return f"{on} by an unknown publisher"
    if publication.entity:
        return f"published by {name_of(publication.entity, timeline)} {on}"
    node = timeline.nodes.get(publication.node)
    return f"published by {node or 'the robot'} {on}"


def _waits_before(timeline: Timeline, span: Span) -> list[Wait]:
    """Return the waits that ended with a call, in order: those since the callback became ready."""
    reach = _FIRST_REACH
    while True:
        window = Window(max(0, span.start - reach), span.start + 1)
        waits = [wait for wait in timeline.waits_of(span.entity, window) if wait.start < span.start]
        before = [one.start for one in timeline.spans_of(span.entity, window) if one.start < span.start]
        if waits or before or window.start == 0:
            break
        reach *= 4
    last = waits[-1] if waits else None
    if last is None or last.end is None or last.end > span.start or any(at >= last.end for at in before):
        return []
    ended = timeline.waits_of(span.entity, Window(last.since, span.start + 1))
    return [wait for wait in ended if wait.since == last.since and wait.start < span.start]


def _reasons(timeline: Timeline, waits: Sequence[Wait]) -> str:
    by_length = sorted(waits, key=lambda wait: wait.start - (wait.end or wait.start))
    longest = dict.fromkeys(_reason(timeline, wait) for wait in by_length)
    return ", and ".join(list(longest)[:_MOST_REASONS])


def _reason(timeline: Timeline, wait: Wait) -> str:
    if wait.is_for_own_call and wait.holder:
        return "its last call still ran"
    return why_waiting(wait, timeline)


# a wait, and a call of a service


def _who_waits(timeline: Timeline, wait: Wait, now: Nanoseconds) -> str:
    lasts = wait.end is None or wait.end > now
    verb = "waits" if lasts else "waited"
    if lasts and now < wait.since + WORTH_TELLING:
        verb = "is ready"
    return f"{_with_letter(timeline, wait.entity)} {verb}"


def _of_wait(timeline: Timeline, wait: Wait, now: Nanoseconds) -> Iterator[str]:
    until = now if wait.end is None or wait.end > now else wait.end
    yield f"{_of_all(until - wait.start, wait, timeline)} from {timestamp(wait.start)}"
    yield _reason(timeline, wait)
    since = waits_since(wait, timeline.queue(wait.entity, max(until - 1, wait.start)), timeline)
    if since < wait.start:
        yield f"{'ready' if since == wait.since else 'next in its queue'} since {timestamp(since)}"
    if wait.workers_busy and wait.reason is not Reason.NO_FREE_WORKER:
        yield "no thread was free either"
    entity = timeline.entities.get(wait.entity)
    if entity is not None and entity.depth:
        at = max(until - 1, wait.start)
        queue = timeline.queue(entity.id, at)
        lost = timeline.drops_of(entity.id, Window(wait.start, at + 1))
        yield f"queue {queue.depth}/{entity.depth}" + (f", {lost} lost in this time" if lost else "")


def _of_call(timeline: Timeline, call: Call, now: Nanoseconds) -> Iterator[str]:
    yield f"{called_by(call, timeline)} at {timestamp(call.sent)}"
    yield call.request
    if call.replied is not None and call.replied <= now:
        yield f"replied after {duration(call.replied - call.sent)}: {call.response}"
    elif call.lost:
        yield "lost: nobody offered the service"
    else:
        yield f"no reply for {duration(now - call.sent)}"


def _call(timeline: Timeline, span: Span) -> Call | None:
    """Return the call that a service's callback answers, by the number of its request."""
    out = timeline.calls_within(Window(max(0, span.start - 1), span.start + 1))
    return next((call for call in out if call.id == span.message), None)


# words


def _of_all(lasted: Nanoseconds, bar: Span | Wait, timeline: Timeline) -> str:
    """How long a bar has lasted at the cursor, and how long it lasts if that is known to be longer."""
    whole = duration(bar.end_at(timeline.end) - bar.start)
    took = duration(lasted)
    return took if took == whole else f"{took} of {whole}"


def _with_letter(timeline: Timeline, entity: EntityId) -> str:
    known = timeline.entities.get(entity)
    group = None if known is None else timeline.groups.get(known.group)
    name = name_of(entity, timeline)
    return name if group is None else f"{group.letter} {name}"
