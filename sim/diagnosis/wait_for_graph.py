"""The wait-for graph of callbacks, groups and threads at one moment, and its deadlocks.

A callback that is blocked in ``Client.call``, or suspended in ``await``, needs a reply, and so does one that
waits for the reply in a loop or for an event. The reply needs the service's callback, then the client, then a
worker for the future's done-callback. ``Rate.sleep`` needs the rate's timer, ``Clock.sleep_for`` on simulated
time the subscription of ``/clock``, a lock its holder, ``Thread.join`` the thread, a job its pool's thread,
and an awaited future what completes it. Each of these can wait for other callbacks: those that hold its
group, those that occupy the threads, or the service's callback, which may be blocked itself. A callback is
stuck if all callbacks that it waits for are stuck. With a timeout it is stuck until that is over.

Source: the usual test of a wait-for graph in which a request for one of several equal resources waits for
all their owners to be stuck (Holt, "Some Deadlock Properties of Computer Systems", 1972).
"""

from bisect import bisect_left
from collections.abc import Iterator
from operator import attrgetter
from pathlib import Path

from sim.diagnosis.edits.flags import completers
from sim.diagnosis.lasting_waits import lasting_awaits, stands
from sim.diagnosis.rule import WaitedFor, is_models
from sim.diagnosis.time_limits import ends_by_itself, time_limit
from sim.diagnosis.timeline_view import pool_of
from sim.diagnosis.waiters import Obstacle, OnThread, StuckCallback, Suspended, Waiter, thread_name
from sim.diagnosis.words import awaited_lock, group_of, listed, threads_for, who
from sim.trace.events import CallId, Doing, EntityId, EntityKind, GroupKind, Reason, ThreadId
from sim.trace.model import RESULT, Call, Moment, Nanoseconds, Position, Span, Window
from sim.trace.timeline import Timeline


class WaitForGraph:
    """The callbacks at ``at`` that wait for what cannot come while they wait, as far as the trace shows."""

    def __init__(self, timeline: Timeline, at: Nanoseconds) -> None:
        self._timeline = timeline
        self._at = at
        self._moment: Moment = timeline.moment(at)
        self._threads_of = self._threads_by_entity()
        self._queued_at = dict(self._queue_owners())
        self._suspended = self._suspended_callbacks()
        self.stuck = self._permanently_stuck(dict(self._waiting()))

    def deadlocks(self) -> Iterator[tuple[StuckCallback, ...]]:
        """The sets of callbacks that wait only for each other, each in waiting order."""
        reach = {waiter: self._reachable(waiter) for waiter in self.stuck}
        seen: set[Waiter] = set()
        for waiter, reached in reach.items():
            if waiter in seen or any(waiter not in reach[other] for other in reached):
                continue
            seen |= reached
            yield self._in_order(reached)

    def _reachable(self, waiter: Waiter) -> frozenset[Waiter]:
        reached: set[Waiter] = set()
        pending = [waiter]
        while pending:
            for other in self.stuck[pending.pop()].obstacle.by:
                if other not in reached:
                    reached.add(other)
                    pending.append(other)
        return frozenset(reached)

    def _in_order(self, deadlock: frozenset[Waiter]) -> tuple[StuckCallback, ...]:
        """Sort by waiting: the last callback first, each followed by one that it waits for, if possible."""
        left = sorted(
            (self.stuck[waiter] for waiter in deadlock), key=lambda each: (not each.entity, -each.since)
        )
        order = [left.pop(0)]
        while left:
            keepers = [each for each in left if each.waiter in order[-1].obstacle.by]
            following = (keepers or left)[0]
            left.remove(following)
            order.append(following)
        return tuple(order)

    def _permanently_stuck(self, waiting: dict[Waiter, StuckCallback]) -> dict[Waiter, StuckCallback]:
        stuck = waiting
        while True:
            left = {
                waiter: each
                for waiter, each in stuck.items()
                if all(other in stuck for other in each.obstacle.by)
            }
            if len(left) == len(stuck):
                return stuck
            stuck = left

    # the waiting callbacks

    def _waiting(self) -> Iterator[tuple[Waiter, StuckCallback]]:
        for thread, blocked in self._moment.blocked.items():
            call = self._call(blocked.call)
            obstacle = None if call is None else self._obstacle(call)
            position = self._timeline.position_on(thread, self._at)
            until = 0 if position is None else position.until
            if obstacle is not None:
                yield (
                    OnThread(thread),
                    StuckCallback(OnThread(thread), blocked.entity, blocked.start, obstacle, until),
                )
        for thread, span in self._moment.running.items():
            position = self._timeline.position_on(thread, self._at)
            if thread in self._moment.blocked or position is None:
                continue
            is_still = stands(position, self._timeline, self._at)
            obstacle = self._obstacle_at(position, span) if is_still else None
            if obstacle is not None:
                since = span.start if position.loop[0] else position.start
                until = time_limit(position)
                yield OnThread(thread), StuckCallback(OnThread(thread), span.entity, since, obstacle, until)
        for entity in self._suspended:
            begun = [span.start for _, span in self._running_spans() if span.entity == entity]
            until = min(begun, default=self._at)  # what was sent later may be of a call that runs
            calls = [call for call in self._outstanding() if call.caller == entity and call.sent <= until]
            obstacles = [self._obstacle(call) for call in calls]
            kept = [each for each in obstacles if each is not None]
            if kept and len(kept) == len(obstacles) >= self._suspended_in(entity):
                yield Suspended(entity), StuckCallback(Suspended(entity), entity, calls[-1].sent, kept[-1])
            for each in () if calls else lasting_awaits(entity, self._at, self._timeline):
                if (obstacle := self._completion_obstacle(each)) is not None:
                    yield Suspended(entity), StuckCallback(Suspended(entity), entity, each.start, obstacle)

    def _suspended_callbacks(self) -> list[EntityId]:
        """The callbacks with suspended calls: those on no thread, and those that await with a lock."""
        holders = {entity for holding in self._moment.holders.values() for entity in holding}
        stands = (self._timeline.position_on(thread, self._at) for thread in self._moment.running)
        keepers = {each.keeper for each in stands if each is not None and self._awaits_with_lock(each)}
        return sorted(holders - self._threads_of.keys() | keepers)

    def _awaits_with_lock(self, wanting: Position) -> bool:
        """Whether a call awaits behind the line at which its callback took a lock, and has since the wait."""
        file, line = wanting.taken_at
        awaits = lasting_awaits(wanting.keeper, self._at, self._timeline) if wanting.keeper else ()
        earlier = (each for each in awaits if each.start <= wanting.start)
        return any(frame.file == file and frame.line > line for each in earlier for frame in each.frames)

    def _suspended_in(self, entity: EntityId) -> int:
        """The number of suspended calls of an entity's callback, as far as the trace shows."""
        if self._timeline.entities[entity].kind is not EntityKind.SERVICE:
            return 1
        running = {span.message for _, span in self._running_spans() if span.entity == entity}
        pending = (call.id for call in self._moment.pending_calls if self._serves(entity, call))
        lost = self._timeline.drops_of(entity, Window(0, self._at + 1))
        return max(1, sum(call not in running and call not in self._queued_at for call in pending) - lost)

    def _outstanding(self) -> Iterator[Call]:
        yield from self._moment.pending_calls
        for number in self._queued_at:
            call = self._call(number)
            if call is not None and self._is_answered(call):
                yield call
        for wait in self._moment.waiting.values():  # the replies that an action's client has not taken
            action, _, end = self._timeline.entities[wait.entity].name.partition(" ")
            taken = self._timeline.calls_begun(wait.entity, Window(0, self._at + 1))[-1:]
            since = Window(max([0, *(each.start for each in taken)]), self._at + 1)
            for call in self._timeline.calls_within(since) if end == "client" else ():
                if call.service.startswith(f"{action}/_action/") and self._is_answered(call):
                    yield call

    def _is_answered(self, call: Call) -> bool:
        return call.replied is not None and call.replied <= self._at

    def _obstacle_at(self, position: Position, span: Span) -> Obstacle | None:
        """What a callback at a line waits for; None: nothing known, or nothing permanent."""
        if position.keeper or position.holder:
            return self._held_obstacle(position)
        if position.call == "Rate.sleep":
            timer = self._waiting_of_rclpy(EntityKind.TIMER, span)
            if timer is not None:
                return self._admission_obstacle(timer, WaitedFor.RATE, WaitedFor.RATE)
        if position.call.startswith("Clock.sleep"):
            waits = position.doing is Doing.WAITS  # on simulated time
            return self._clock_obstacle(span) if waits else None
        if position.doing is Doing.WAITS or (position.loop[0] and not ends_by_itself(*position.loop)):
            pending = (call for call in self._outstanding() if call.caller == span.entity)
            for call in pending:
                if call.sent >= span.start:
                    computes = position.doing is not Doing.WAITS
                    return self._obstacle(call) or (self._busy_obstacle(call, span) if computes else None)
        return None

    def _held_obstacle(self, position: Position) -> Obstacle:
        """A thread, its job or a lock: what a call that is over left locked is waited for in a row."""
        me, keeper, more = self._name(OnThread(position.thread)), position.keeper, ""
        holder: Waiter = OnThread(position.holder)
        if not position.waits_for_lock:
            ends, thread = position.call != RESULT, thread_name(holder, self._timeline)
            text = f"{me} waits for {thread} to end" if ends else f"{me} waits for the job on {thread}"
            return Obstacle(WaitedFor.THREAD if ends else WaitedFor.JOB, text, (holder,))
        if keeper in self._suspended:
            more, holder = " and keeps while it awaits", Suspended(keeper)
        elif keeper:
            stands = (self._timeline.position_on(thread, self._at) for thread in self._moment.running)
            waits = [each for each in stands if each is not None and each.keeper == keeper]
            holder = OnThread(min(waits, key=attrgetter("start")).thread)
        text = f"{me} wants {awaited_lock(position, self._timeline, more)}"
        return Obstacle(WaitedFor.LOCK, text, (holder,), name=position.lock)

    def _busy_obstacle(self, call: Call, span: Span) -> Obstacle | None:
        """A loop that computes keeps a reply from its client, even one that is not there yet."""
        if call.lost:
            return None
        me, known, by = (
            self._timeline.entities[span.entity],
            self._timeline.entities,
            (OnThread(span.thread),),
        )
        if threads_for([me.id], self._at, self._timeline) == 1:
            return self._worker_obstacle(by, call.service, f"the reply of {call.service}")
        clients = (each for each in known.values() if each.kind is EntityKind.CLIENT and each.node == me.node)
        groups = {each.group for each in clients if each.name == call.service}
        is_mine = groups == {me.group} and self._timeline.groups[me.group].kind is GroupKind.EXCLUSIVE
        name = group_of(me.id, self._timeline)
        text = f"the reply of {call.service} waits for {name}, which {self._names(by)} holds"
        return Obstacle(call.service, text, by, group=name) if is_mine else None

    def _waiting_of_rclpy(self, kind: EntityKind, span: Span, name: str = "") -> EntityId | None:
        """What rclpy made for the node of a call and now waits: a rate's timer, a clock's subscription."""
        node = self._timeline.entities[span.entity].node
        for entity in self._moment.waiting:
            known = self._timeline.entities[entity]
            if known.kind is kind and known.node == node and is_models(known) and name in ("", known.name):
                return entity
        return None

    # the obstacles

    def _obstacle(self, call: Call) -> Obstacle | None:
        """What the reply of a call waits for; None: nothing known, or nothing permanent."""
        owner = self._queued_at.get(call.id, self._waiting_action(call))
        if owner is not None:
            return self._queue_obstacle(owner, call)
        if not self._is_answered(call):
            return self._service_obstacle(call)
        return self._future_obstacle(call)

    def _clock_obstacle(self, span: Span) -> Obstacle | None:
        """What simulated time waits for: a message of it, or the callback that published the last one."""
        clock = self._waiting_of_rclpy(EntityKind.SUBSCRIPTION, span, "/clock")
        if clock is not None:
            return self._admission_obstacle(clock, WaitedFor.CLOCK, "/clock")
        sent = self._timeline.sent_on("/clock")
        sender = sent[-1].sender if sent else None
        if sender is None:
            return None
        needs = f"{who(sender.entity, self._timeline)}, which publishes on /clock,"
        return self._admission_obstacle(sender.entity, WaitedFor.CLOCK, needs)

    def _completion_obstacle(self, position: Position) -> Obstacle | None:
        """The callbacks that complete an awaited future, all in groups that keep others out just now."""
        known, ends = self._timeline.entities, completers(position.file, position.line)
        node, by, clauses = known[position.entity].node, list[Waiter](), list[str]()
        waiting = (each for each, wait in self._moment.waiting.items() if wait.reason is Reason.GROUP_HELD)
        closed = {known[each].group for each in waiting}
        for function, call, line in ends:
            mine = [each for each in known.values() if (each.node, each.spoken_name) == (node, function)]
            if len(mine) != 1 or mine[0].group not in closed:
                return None
            holders = self._moment.holders[mine[0].group]
            by += (waiter for each in holders for waiter in self._waiters(each))
            group, file = group_of(mine[0].id, self._timeline), Path(position.file).name
            keepers = listed(who(each, self._timeline) for each in holders)
            clauses.append(f"{call}() in {function} ({file}:{line}) needs {group}, which {keepers} holds")
        name = ends[0][1].removesuffix(".set_result") if ends else ""
        return Obstacle(WaitedFor.FUTURE, "; ".join(clauses), (*by,), group=group, name=name) if by else None

    def _waiting_action(self, call: Call) -> EntityId | None:
        """The action server or client that a request or reply waits for; their queues are not traced."""
        action, _, of_action = call.service.partition("/_action/")
        for entity in self._moment.waiting if of_action else ():
            known = self._timeline.entities[entity]
            if (
                known.kind is EntityKind.WAITABLE
                and known.name.partition(" ")[0] == action
                and not known.callback
            ):
                return entity
        return None

    def _queue_obstacle(self, owner: EntityId, call: Call) -> Obstacle | None:
        """The request or reply is in a queue."""
        needs = f"the reply of {call.service}" if self._is_answered(call) else call.service
        return self._admission_obstacle(owner, call.service, needs)

    def _admission_obstacle(self, owner: EntityId, wanted: str, needs: str) -> Obstacle | None:
        """A ready callback, or the reply to a client, waits for its group or for a thread."""
        wait = self._moment.waiting.get(owner)
        if wait is None:
            return None
        known = self._timeline.entities[owner]
        if wait.reason is Reason.GROUP_HELD:
            group = self._timeline.groups.get(known.group)
            if group is None or group.kind is not GroupKind.EXCLUSIVE:
                return None
            by = tuple(waiter for each in self._moment.holders[known.group] for waiter in self._waiters(each))
            if not by:
                return None
            name = group_of(owner, self._timeline)
            text = f"{needs} waits for {name}, which {self._names(by)} holds"
            return Obstacle(wanted, text, by, group=name, since=wait.start)
        if wait.reason in (Reason.NO_FREE_WORKER, Reason.EVENT_QUEUE) and wait.holder:
            return self._worker_obstacle(self._pool(wait.holder), wanted, needs, wait.start)
        return None

    def _service_obstacle(self, call: Call) -> Obstacle | None:
        """The service's callback is handling the call."""
        for thread, span in self._running_spans():
            entity = self._timeline.entities.get(span.entity)
            if entity is not None and self._serves(entity.id, call) and span.message == call.id:
                return self._callback_obstacle(call, entity.id, OnThread(thread), span.start)
        for suspended in self._suspended:
            if self._serves(suspended, call):
                return self._callback_obstacle(call, suspended, Suspended(suspended))
        return None

    def _callback_obstacle(
        self, call: Call, entity: EntityId, by: Waiter, since: Nanoseconds = 0
    ) -> Obstacle:
        text = f"{call.service} is answered by {who(entity, self._timeline)}"
        return Obstacle(call.service, text, (by,), since=since)

    def _serves(self, entity: EntityId, call: Call) -> bool:
        known = self._timeline.entities[entity]
        return known.kind is EntityKind.SERVICE and known.name == call.service

    def _future_obstacle(self, call: Call) -> Obstacle | None:
        """The reply was taken, and the future's done-callback needs a worker."""
        since = Window(call.replied or 0, self._at + 1)
        for entity in self._timeline.entities.values():
            if entity.kind is EntityKind.CLIENT and entity.name == call.service:
                for span in self._timeline.spans_of(entity.id, since):
                    if span.message == call.id:
                        pool = tuple(map(OnThread, pool_of(span.thread, self._timeline)))
                        needs = f"the reply of {call.service}"
                        return self._worker_obstacle(pool, call.service, needs, span.end_at(self._at))
        return None

    def _worker_obstacle(
        self, pool: tuple[Waiter, ...], wanted: str, needs: str, since: Nanoseconds = 0
    ) -> Obstacle | None:
        if not pool:
            return None
        if len(pool) == 1:
            text = f"{needs} needs the only thread, which {self._names(pool)} keeps"
        else:
            every = "both" if len(pool) == 2 else f"all {len(pool)}"
            same = len({self._name(waiter) for waiter in pool}) == 1
            where = f"{' in' if same else ':'} {self._names(pool)}"
            text = f"{needs} needs a thread, and {every} stand still{where}"
        return Obstacle(wanted, text, pool, needs_worker=True, since=since)

    # threads and queues

    def _threads_by_entity(self) -> dict[EntityId, list[ThreadId]]:
        found: dict[EntityId, list[ThreadId]] = {}
        for thread, span in self._running_spans():
            found.setdefault(span.entity, []).append(thread)
        return found

    def _running_spans(self) -> Iterator[tuple[ThreadId, Span]]:
        """All running calls, including those around nested ones."""
        for thread in self._timeline.threads:
            for span in self._timeline.spans_on(thread, Window(self._at, self._at + 1)):
                if span.end is None or span.end > self._at:
                    yield thread, span

    def _waiters(self, entity: EntityId) -> list[Waiter]:
        threads = self._threads_of.get(entity)
        return [Suspended(entity)] if threads is None else [OnThread(thread) for thread in threads]

    def _pool(self, holder: EntityId) -> tuple[Waiter, ...]:
        threads = self._threads_of.get(holder, [])
        return tuple(OnThread(each) for each in pool_of(threads[0], self._timeline)) if threads else ()

    def _names(self, waiters: tuple[Waiter, ...]) -> str:
        return listed(self._name(waiter) for waiter in waiters)

    def _name(self, waiter: Waiter) -> str:
        if isinstance(waiter, Suspended):
            return who(waiter.entity, self._timeline)
        span = self._moment.running.get(waiter.thread)
        if span is None:
            return "another callback"
        position = self._timeline.position_on(waiter.thread, self._at)
        line = "" if position is None else f" ({Path(position.file).name}:{position.line})"
        return f"{who(span.entity, self._timeline)}{line}"

    def _queue_owners(self) -> Iterator[tuple[CallId, EntityId]]:
        """Each queued request or reply, and the entity whose queue has it."""
        for entity in self._timeline.entities.values():
            if entity.kind in (EntityKind.CLIENT, EntityKind.SERVICE):
                for each in self._moment.queues[entity.id].messages:
                    yield each.id, entity.id

    def _call(self, number: CallId) -> Call | None:
        """A call by its number; numbers ascend in the order of sending."""
        calls = self._timeline.calls
        place = bisect_left(calls, number, key=attrgetter("id"))
        return calls[place] if place < len(calls) and calls[place].id == number else None
