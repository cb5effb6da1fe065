"""The arrows of a run: from a message's publication to each callback that takes it, from call to reply."""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from itertools import count

from sim.export.trace_sink import FlowId
from sim.trace.events import CallId, EntityId


class Flows:
    """Open flows; each is ended once.

    A flow to an entity's queue is on its way until it arrives, and then waits in order of arrival. Numbers
    are of messages, or of calls for the entities of services and clients.
    """

    def __init__(self) -> None:
        self._ids = count(1)
        self._on_the_way: defaultdict[EntityId, dict[int, FlowId]] = defaultdict(dict)
        self._queued: defaultdict[EntityId, dict[int, FlowId]] = defaultdict(dict)
        self._calls: dict[CallId, FlowId] = {}

    def send(self, number: int, receivers: Sequence[EntityId]) -> tuple[FlowId, ...]:
        """Open a flow to each receiver of a message, request or reply that has none with that number."""
        fresh = dict.fromkeys(entity for entity in receivers if not self._has(number, entity))
        return tuple(self._begin(number, entity) for entity in fresh)

    def arrive(self, number: int, entity: EntityId, depth: int) -> Iterator[FlowId]:
        """A message arrives at a queue, now of ``depth``; ends the flows of messages that left unseen."""
        flow = self._on_the_way[entity].pop(number, None)
        queued = self._queued[entity]
        if flow is not None:
            queued[number] = flow
        while len(queued) > max(depth, 1):
            yield queued.pop(next(iter(queued)))

    def take(self, number: int, entity: EntityId) -> tuple[FlowId, ...]:
        """End the flow of what an entity's callback takes, or its queue loses."""
        for where in (self._queued, self._on_the_way):
            flow = where[entity].pop(number, None)
            if flow is not None:
                return (flow,)
        return ()

    def empty(self, entity: EntityId) -> tuple[FlowId, ...]:
        """End all flows to an entity."""
        queued, on_the_way = self._queued.pop(entity, {}), self._on_the_way.pop(entity, {})
        return (*queued.values(), *on_the_way.values())

    def receivers(self) -> tuple[EntityId, ...]:
        """The entities to which flows are open."""
        return tuple({**self._queued, **self._on_the_way})

    def call(self, call: CallId) -> tuple[FlowId, ...]:
        """Open the flow from a call to its reply, unless it is open."""
        if call in self._calls:
            return ()
        self._calls[call] = next(self._ids)
        return (self._calls[call],)

    def served(self, call: CallId) -> tuple[FlowId, ...]:
        """The flow of a call that a service's callback takes."""
        flow = self._calls.get(call)
        return () if flow is None else (flow,)

    def reply(self, call: CallId) -> tuple[FlowId, ...]:
        """End the flow of a call."""
        flow = self._calls.pop(call, None)
        return () if flow is None else (flow,)

    def unanswered(self) -> tuple[FlowId, ...]:
        """End the flows of all calls without a reply."""
        flows = tuple(self._calls.values())
        self._calls.clear()
        return flows

    def _has(self, number: int, entity: EntityId) -> bool:
        return number in self._on_the_way[entity] or number in self._queued[entity]

    def _begin(self, number: int, entity: EntityId) -> FlowId:
        flow = next(self._ids)
        self._on_the_way[entity][number] = flow
        return flow
