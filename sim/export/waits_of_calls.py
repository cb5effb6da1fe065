"""Tells for how long the message of each call, or its callback, has waited, event by event."""

from collections import defaultdict

from sim.trace.events import CallbackStarted, EntityId, EntityReady, MessageDropped, WaitEnded, WaitStarted
from sim.trace.figures.waiting import wait_began
from sim.trace.model import Nanoseconds, Wait


class WaitsOfCalls:
    """The waits of ready callbacks, and what is in their queues. Not thread-safe."""

    def __init__(self) -> None:
        self._waiting: dict[EntityId, Wait] = {}
        self._waited: dict[EntityId, Wait] = {}
        self._kept_since: dict[EntityId, Nanoseconds] = {}
        self._arrived: defaultdict[EntityId, dict[int, Nanoseconds]] = defaultdict(dict)

    def arrive(self, event: EntityReady) -> None:
        """A message arrives; those that left the queue unseen are forgotten."""
        if event.message:
            queued = self._arrived[event.entity]
            queued[event.message] = event.t
            while len(queued) > max(event.depth, 1):
                del queued[next(iter(queued))]

    def lose(self, event: MessageDropped) -> None:
        """A queue loses a message."""
        self._arrived[event.entity].pop(event.message, None)

    def start(self, event: WaitStarted) -> Wait:
        """A wait starts, or goes on for another reason."""
        wait = Wait(event.t, None, event.since, event.entity, event.reason, event.holder, event.workers_busy)
        before = self._waiting.get(event.entity)
        if before is None or before.since != event.since:
            self._kept_since[event.entity] = event.since
        elif before.is_for_own_call:
            self._kept_since[event.entity] = min([*self._arrived[event.entity].values(), event.t])
        self._waiting[event.entity] = wait
        return wait

    def end(self, event: WaitEnded) -> None:
        """A wait ends."""
        wait = self._waiting.pop(event.entity, None)
        if wait is not None:
            self._waited[event.entity] = wait

    def before(self, event: CallbackStarted) -> Nanoseconds:
        """Return for how long a call has waited that begins now."""
        arrived = self._arrived[event.entity].pop(event.message, None)
        wait = self._waited.pop(event.entity, None)
        return 0 if wait is None else event.t - wait_began(wait, self._kept_since[event.entity], arrived)
