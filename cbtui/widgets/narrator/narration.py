"""What the narrator tells: the executor's decisions at a moment, and their reasons, for each callback."""

from collections.abc import Iterator, Sequence

from cbtui.widgets.narrator.decisions import deeds
from cbtui.widgets.narrator.waits import readied, waits_told
from sim.quantities.durations import timestamp
from sim.trace.descriptions import name_of
from sim.trace.events import Doing, EntityId, ThreadId
from sim.trace.figures.waiting import (
    just_due,
    waits_at,
)
from sim.trace.model import Nanoseconds, Window
from sim.trace.timeline import Timeline

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
    return (f"{timestamp(last)}: {first}", *more, *waits_told(timeline, at, last))


def decisions_at(timeline: Timeline, at: Nanoseconds, stepped: bool = True) -> int:
    """Return with how many sentences ``narration`` tells what was decided at a moment; at least 1."""
    last = at if stepped else timeline.neighbour(at + 1, -1)
    return 1 if last is None else max(1, len(_decided(timeline, last)))


def decided_about(timeline: Timeline, at: Nanoseconds, place: int) -> tuple[EntityId, ThreadId | None] | None:
    """Return the callback and the thread, if any, that a decision of a moment is about.

    ``place`` counts from 0, -1 is the last.
    """
    about = [(entity, thread) for entity, thread, _ in deeds(timeline, at)]
    return about[place] if -len(about) <= place < len(about) else None


def _decided(timeline: Timeline, at: Nanoseconds) -> Sequence[str]:
    """What was decided at a moment; who has become ready, if that is all, as it is told with the waits."""
    ready = [
        f"{name_of(wait.entity, timeline)} {readied(wait, timeline)}"
        for wait in waits_at(timeline.moment(at), timeline)
        if wait.since == at
    ]
    return tuple(told for *_, told in deeds(timeline, at)) or tuple(filter(None, ("; ".join(ready),)))


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
    return (first, *waits_told(timeline, at, at))


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
