"""Who waits for what that who holds, at one moment, and which of them can never go on.

A callback that stands still in ``Client.call`` (or is suspended in ``await``) needs its reply, and on the way
to it, in turn: the service's callback, the client, and a worker for the future's done-callback. Each of
these can be kept by other callbacks: by who holds its group, by who is on the threads, by the service's
callback that itself stands still. Whoever is kept only by such as are kept themselves stays so for ever.

Source: the usual test of a wait-for graph in which a request for one of several equal resources waits for
all their owners to be stuck (Holt, "Some Deadlock Properties of Computer Systems", 1972).
"""

from bisect import bisect_left
from collections.abc import Iterator
from dataclasses import dataclass
from operator import attrgetter
from typing import TypeAlias

from sim.diagnosis.timeline_view import pool_of
from sim.diagnosis.words import group_of, who
from sim.trace.events import CallId, EntityId, EntityKind, GroupKind, Reason, ThreadId
from sim.trace.model import Call, Moment, Nanoseconds, Span, Window
from sim.trace.timeline import Timeline


@dataclass(frozen=True, slots=True)
class OnThread:
    """A thread, with the callback on it."""

    thread: ThreadId


@dataclass(frozen=True, slots=True)
class Suspended:
    """A coroutine callback that is on no thread and keeps its group."""

    entity: EntityId


Waiter: TypeAlias = OnThread | Suspended


@dataclass(frozen=True, slots=True)
class Obstacle:
    """What a call waits for, in words, and by whom it is kept: one of ``by`` would have to go on.

    ``needs_worker``: it is a thread that is missing.
    """

    service: str
    text: str
    by: tuple[Waiter, ...]
    needs_worker: bool = False


@dataclass(frozen=True, slots=True)
class Stuck:
    """One that can never go on: the callback, since when it waits, and why."""

    actor: Waiter
    entity: EntityId
    since: Nanoseconds
    obstacle: Obstacle


class WaitForGraph:
    """The callbacks that can never go on at ``at``, as far as the trace tells."""

    def __init__(self, timeline: Timeline, at: Nanoseconds) -> None:
        self._timeline = timeline
        self._at = at
        self._moment: Moment = timeline.moment(at)
        self._threads_of = self._threads_by_entity()
        self._carriers = dict(self._carried())
        self.stuck = self._without_those_that_go_on(dict(self._waiting()))

    def knots(self) -> Iterator[tuple[Stuck, ...]]:
        """The sets of callbacks that only wait for each other, each in the order of its waiting."""
        reach = {actor: self._reach(actor) for actor in self.stuck}
        told: set[Waiter] = set()
        for actor, reached in reach.items():
            if actor in told or any(actor not in reach[other] for other in reached):
                continue
            told |= reached
            yield self._in_order(reached)

    def _reach(self, actor: Waiter) -> frozenset[Waiter]:
        reached: set[Waiter] = set()
        coming = [actor]
        while coming:
            for other in self.stuck[coming.pop()].obstacle.by:
                if other not in reached:
                    reached.add(other)
                    coming.append(other)
        return frozenset(reached)

    def _in_order(self, knot: frozenset[Waiter]) -> tuple[Stuck, ...]:
        """From the one that began to wait last on, each followed by one that keeps it, where possible."""
        left = sorted((self.stuck[actor] for actor in knot), key=lambda each: -each.since)
        order = [left.pop(0)]
        while left:
            keepers = [each for each in left if each.actor in order[-1].obstacle.by]
            following = (keepers or left)[0]
            left.remove(following)
            order.append(following)
        return tuple(order)

    def _without_those_that_go_on(self, waiting: dict[Waiter, Stuck]) -> dict[Waiter, Stuck]:
        stuck = waiting
        while True:
            left = {
                actor: each
                for actor, each in stuck.items()
                if all(other in stuck for other in each.obstacle.by)
            }
            if len(left) == len(stuck):
                return stuck
            stuck = left

    # who waits for a reply

    def _waiting(self) -> Iterator[tuple[Waiter, Stuck]]:
        for thread, blocked in self._moment.blocked.items():
            call = self._call(blocked.call)
            obstacle = None if call is None else self._obstacle(call, blocked.entity)
            if obstacle is not None:
                yield OnThread(thread), Stuck(OnThread(thread), blocked.entity, blocked.start, obstacle)
        for entity in self._suspended():
            calls = [call for call in self._outstanding() if call.caller == entity]
            obstacles = [self._obstacle(call, entity) for call in calls]
            kept = [each for each in obstacles if each is not None]
            if kept and len(kept) == len(obstacles) >= self._suspended_in(entity):
                yield Suspended(entity), Stuck(Suspended(entity), entity, calls[-1].sent, kept[-1])

    def _suspended(self) -> list[EntityId]:
        holders = {entity for holding in self._moment.holders.values() for entity in holding}
        return sorted(holders - self._threads_of.keys())

    def _suspended_in(self, entity: EntityId) -> int:
        """In how many calls of an entity's callback it is suspended, as far as the trace tells."""
        if self._timeline.entities[entity].kind is not EntityKind.SERVICE:
            return 1
        running = {span.message for _, span in self._spans() if span.entity == entity}
        pending = (call.id for call in self._moment.pending_calls if self._serves(entity, call))
        return sum(call not in running and call not in self._carriers for call in pending)

    def _outstanding(self) -> Iterator[Call]:
        yield from self._moment.pending_calls
        for number in self._carriers:
            call = self._call(number)
            if call is not None and self._is_answered(call):
                yield call

    def _is_answered(self, call: Call) -> bool:
        return call.replied is not None and call.replied <= self._at

    # what the reply waits for

    def _obstacle(self, call: Call, caller: EntityId) -> Obstacle | None:
        """What keeps the reply of a call; None: nothing that the trace knows, or nothing for long."""
        carrier = self._carriers.get(call.id)
        if carrier is not None:
            return self._before(carrier, call)
        if not self._is_answered(call):
            return self._served(call)
        return self._done_callback(call, caller)

    def _before(self, carrier: EntityId, call: Call) -> Obstacle | None:
        """The request or reply lies in a queue."""
        wait = self._moment.waiting.get(carrier)
        if wait is None:
            return None
        known = self._timeline.entities[carrier]
        needing = f"the reply of {call.service}" if self._is_answered(call) else call.service
        if wait.reason is Reason.GROUP_HELD:
            group = self._timeline.groups.get(known.group)
            if group is None or group.kind is not GroupKind.EXCLUSIVE:
                return None
            by = tuple(actor for each in self._moment.holders[known.group] for actor in self._actors(each))
            text = f"{needing} waits for {group_of(carrier, self._timeline)}, which {self._names(by)} holds"
            return Obstacle(call.service, text, by) if by else None
        if wait.reason is Reason.NO_FREE_WORKER and wait.holder:
            return self._worker(self._pool(wait.holder), call.service, needing)
        return None

    def _served(self, call: Call) -> Obstacle | None:
        """The service's callback is at it."""
        for thread, span in self._spans():
            entity = self._timeline.entities.get(span.entity)
            if entity is not None and self._serves(entity.id, call) and span.message == call.id:
                return self._by_service(call, entity.id, OnThread(thread))
        for suspended in self._suspended():
            if self._serves(suspended, call):
                return self._by_service(call, suspended, Suspended(suspended))
        return None

    def _by_service(self, call: Call, entity: EntityId, by: Waiter) -> Obstacle:
        return Obstacle(call.service, f"{call.service} is answered by {who(entity, self._timeline)}", (by,))

    def _serves(self, entity: EntityId, call: Call) -> bool:
        known = self._timeline.entities[entity]
        return known.kind is EntityKind.SERVICE and known.name == call.service

    def _done_callback(self, call: Call, caller: EntityId) -> Obstacle | None:
        """The reply was taken, and the future's done-callback needs a worker."""
        since = Window(call.replied or 0, self._at + 1)
        for entity in self._timeline.entities.values():
            if entity.kind is EntityKind.CLIENT and entity.name == call.service:
                for span in self._timeline.spans_of(entity.id, since):
                    if span.message == call.id:
                        pool = tuple(map(OnThread, pool_of(span.thread, self._timeline)))
                        return self._worker(pool, call.service, f"the reply of {call.service}")
        return None

    def _worker(self, pool: tuple[Waiter, ...], service: str, needing: str) -> Obstacle | None:
        if len(pool) == 1:
            text = f"{needing} needs the only thread, which {self._names(pool)} keeps"
        else:
            text = f"{needing} needs a thread, and all {len(pool)} stand still in call(): {self._names(pool)}"
        return Obstacle(service, text, pool, needs_worker=True) if pool else None

    # who is where

    def _threads_by_entity(self) -> dict[EntityId, list[ThreadId]]:
        found: dict[EntityId, list[ThreadId]] = {}
        for thread, span in self._spans():
            found.setdefault(span.entity, []).append(thread)
        return found

    def _spans(self) -> Iterator[tuple[ThreadId, Span]]:
        """All that runs now, outer callbacks of nested ones too."""
        for thread in self._timeline.threads:
            for span in self._timeline.spans_on(thread, Window(self._at, self._at + 1)):
                if span.end is None or span.end > self._at:
                    yield thread, span

    def _actors(self, entity: EntityId) -> list[Waiter]:
        threads = self._threads_of.get(entity)
        return [Suspended(entity)] if threads is None else [OnThread(thread) for thread in threads]

    def _pool(self, holder: EntityId) -> tuple[Waiter, ...]:
        threads = self._threads_of.get(holder, [])
        return tuple(OnThread(each) for each in pool_of(threads[0], self._timeline)) if threads else ()

    def _names(self, actors: tuple[Waiter, ...]) -> str:
        names = dict.fromkeys(self._name(actor) for actor in actors)
        return " and ".join(names)

    def _name(self, actor: Waiter) -> str:
        if isinstance(actor, Suspended):
            return who(actor.entity, self._timeline)
        span = self._moment.running.get(actor.thread)
        return "another callback" if span is None else who(span.entity, self._timeline)

    def _carried(self) -> Iterator[tuple[CallId, EntityId]]:
        """In whose queue each request and reply lies."""
        for entity in self._timeline.entities.values():
            if entity.kind in (EntityKind.CLIENT, EntityKind.SERVICE):
                for each in self._moment.queues[entity.id].messages:
                    yield each.id, entity.id

    def _call(self, number: CallId) -> Call | None:
        """A call by its number; numbers are given in the order of sending."""
        calls = self._timeline.calls
        place = bisect_left(calls, number, key=attrgetter("id"))
        return calls[place] if place < len(calls) and calls[place].id == number else None
