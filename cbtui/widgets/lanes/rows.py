"""The lanes of a run, and the choice of those to show if not all fit."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TypeAlias

from sim.quantities.nanoseconds import SECOND
from sim.trace.events import EntityId, EntityKind, GroupId, ThreadId
from sim.trace.model import EntityInfo, GroupInfo, Nanoseconds, Span, ThreadInfo, Window
from sim.trace.roster import MOST_LANES, roster_of
from sim.trace.timeline import Timeline


@dataclass(frozen=True, slots=True)
class ThreadLane:
    """The calls on a thread."""

    thread: ThreadInfo


@dataclass(frozen=True, slots=True)
class GroupLane:
    """The holders of a group of several callbacks; its members follow in lanes of their own."""

    group: GroupInfo


@dataclass(frozen=True, slots=True)
class MemberLane:
    """The calls and waits of a callback of the group above."""

    entity: EntityInfo
    group: GroupInfo


@dataclass(frozen=True, slots=True)
class SoleLane:
    """A group together with its only callback."""

    entity: EntityInfo
    group: GroupInfo


@dataclass(frozen=True, slots=True)
class ServiceLane:
    """Calls of a service that is not the learner's, such as the robot's ``/motor_power``."""

    service: str


NONE_KEPT: Mapping[EntityId, int] = {}

Lane: TypeAlias = ThreadLane | GroupLane | MemberLane | SoleLane | ServiceLane


def all_lanes(timeline: Timeline, service: str) -> list[Lane]:
    """Return the lanes of a run: threads, then groups with their members, then services of others.

    Groups and members are the first ``MOST_LANES``; ``lanes_beyond`` counts the rest. ``service`` is one
    that has a lane before its first call; "" for none.
    """
    roster = roster_of(timeline)
    lanes: list[Lane] = [ThreadLane(thread) for thread in _working_threads(timeline)]
    for group, members in roster.staged(timeline):
        if roster.size(group.id) == 1:
            lanes.append(SoleLane(members[0], group))
        else:
            lanes.append(GroupLane(group))
            lanes.extend([MemberLane(member, group) for member in members])
    called = dict.fromkeys([service, *timeline.services_called])
    lanes.extend([ServiceLane(name) for name in called if name and name not in roster.services])
    return lanes


def lanes_beyond(lanes: list[Lane], timeline: Timeline) -> int:
    """Return the number of groups and callbacks without a lane."""
    shown = sum([not isinstance(lane, ThreadLane | ServiceLane) for lane in lanes])
    return roster_of(timeline).lanes - shown


def _working_threads(timeline: Timeline) -> list[ThreadInfo]:
    """Return the threads, without a main thread that only dispatches work."""
    threads = list(timeline.threads.values())
    if len(threads) < 2:
        return threads
    end = timeline.end
    return [one for one in threads if one.name != "MainThread" or ever_ran(timeline, one.id, end)]


def ever_ran(timeline: Timeline, thread: ThreadId, at: Nanoseconds) -> bool:
    """Whether a thread ran a callback up to ``at``; examines only the first calls."""
    return bool(first_spans(partial(timeline.spans_on, thread), at))


def first_spans(spans: Callable[[Window], Sequence[Span]], at: Nanoseconds) -> Sequence[Span]:
    """Return the first calls up to ``at``, and maybe some more; ``spans`` returns those in a window."""
    reach = SECOND
    while reach < at:
        if found := spans(Window(0, reach)):
            return found
        reach *= 2
    return spans(Window(0, at + 1))


def never_ran(timeline: Timeline, thread: ThreadId) -> bool:
    """Whether a run is over in which a thread ran no callback."""
    return timeline.ended is not None and not ever_ran(timeline, thread, timeline.end)


def choose_lanes(
    lanes: list[Lane],
    room: int,
    timeline: Timeline,
    window: Window,
    selected: Lane | None = None,
    kept: Mapping[EntityId, int] = NONE_KEPT,
    kept_thread: ThreadId | None = None,
) -> list[Lane]:
    """Return the most important lanes of ``window`` that fit, in their order.

    The selected lane, ``kept_thread`` and the neighbours stay, so that moving through the lanes scrolls the
    view. The callbacks ``kept`` come next, by rank, then lanes with work or long waits; idle ones are
    dropped first, and threads beyond half of the room before callbacks that are called: one thread works
    like another, but the busiest stays. The cursor's moment does not count: the choice would flicker.
    """
    if len(lanes) <= room:
        return lanes
    worth = _LanePriority(timeline, window, kept)
    value = [worth.of(lane) for lane in lanes]
    threads = [place for place, lane in enumerate(lanes) if isinstance(lane, ThreadLane)]
    threads.sort(key=lambda place: -value[place])
    for place in threads[room // 2 :]:
        value[place] = min(value[place], _SPARE)
    for place in threads[:1]:
        value[place] = _BUSIEST
    middle = lanes.index(selected) if selected in lanes else -_FAR
    distance = [min(abs(place - middle), _FAR) for place in range(len(lanes))]
    for place, lane in enumerate(lanes):
        if isinstance(lane, ThreadLane) and lane.thread.id == kept_thread:
            value[place], distance[place] = _KEPT, min(distance[place], 1)
    places = sorted(range(len(lanes)), key=lambda place: (distance[place], -value[place], place))
    return [lanes[place] for place in sorted(places[: max(room, 0)])]


_SPARE = 4
"""The priority of a thread beyond half of the room, or whose calls take no time, and the highest of a client,
which only takes replies."""
_BUSIEST = 9
"""The priority of the busiest thread, and of any that is busy for most of the time: more than of a group."""
_KEPT = 10
"""The least priority of a callback that the picture is about: higher than any other."""
_FAR = 2
"""The distance from the selected lane beyond which only priority counts."""
_LONG_WAIT: Nanoseconds = 10_000_000
_LATEST = 200
"""Waits of a window that are examined for a long one."""


@dataclass(frozen=True, slots=True)
class _LanePriority:
    """The priority of lanes in a window."""

    timeline: Timeline
    window: Window
    kept: Mapping[EntityId, int]

    def of(self, lane: Lane) -> int:
        """Return a lane's priority."""
        match lane:
            case ThreadLane(thread):
                return self._thread(thread)
            case GroupLane(group):
                return 8 if self._group_waits(group.id) else 6
            case MemberLane(entity) | SoleLane(entity) if entity.id in self.kept:
                return _KEPT + len(self.kept) - self.kept[entity.id]
            case MemberLane(entity) | SoleLane(entity):
                of_replies = entity.kind is EntityKind.CLIENT
                return min(_SPARE, self._entity(entity.id)) if of_replies else self._entity(entity.id)
            case ServiceLane(service):
                return 5 if service in self.timeline.services_called else 3

    def _thread(self, thread: ThreadInfo) -> int:
        busy = self.timeline.busy(thread.id, self.window)
        if busy == 0:
            return _SPARE if self.timeline.spans_on(thread.id, self.window) else 2
        return _BUSIEST if busy >= 0.5 else 7

    def _group_waits(self, group: GroupId) -> bool:
        return any(self._waits_long(member.id) for member in self.timeline.group_members(group)[:MOST_LANES])

    def _waits_long(self, entity: EntityId) -> bool:
        latest = self.timeline.waits_of(entity, self.window)[-_LATEST:]
        end = self.timeline.end
        return any((end if wait.end is None else wait.end) - wait.start >= _LONG_WAIT for wait in latest)

    def _entity(self, entity: EntityId) -> int:
        if self._waits_long(entity):
            return 8
        if self.timeline.waits_of(entity, self.window):
            return 7
        return 5 if self.timeline.calls_of(entity, self.window) else 1
