"""Closes the callbacks, blocked calls and entities that a killed process leaves open on the trace."""

from collections.abc import Iterator

from sim.trace.events import (
    AnyEvent,
    CallbackEnded,
    CallbackResumed,
    CallbackStarted,
    CallbackSuspended,
    CallBlocked,
    CallUnblocked,
    EntityAppeared,
    EntityGone,
    EntityId,
    Nanoseconds,
    ThreadId,
)


class LeftOpen:
    """Follows the events of several processes, to close those of one that has ended."""

    def __init__(self) -> None:
        self._entities: dict[EntityId, int] = {}
        """The process of each entity that is there."""
        self._running: dict[tuple[EntityId, ThreadId], None] = {}
        self._blocked: dict[ThreadId, CallBlocked] = {}

    def appeared(self, event: EntityAppeared, process: int) -> None:
        """Note to which process an entity belongs."""
        self._entities[event.entity] = process

    def follow(self, event: AnyEvent) -> None:
        """Follow an event of the trace."""
        match event:
            case CallbackStarted():
                self._running[event.entity, event.thread] = None
            case CallbackResumed():
                self._running[event.entity, event.thread] = None
            case CallbackEnded() | CallbackSuspended():
                self._running.pop((event.entity, event.thread), None)
            case CallBlocked():
                self._blocked[event.thread] = event
            case CallUnblocked():
                self._blocked.pop(event.thread, None)
            case EntityGone():
                self._entities.pop(event.entity, None)

    def closed(self, process: int, t: Nanoseconds) -> Iterator[AnyEvent]:
        """Yield the events that close what an ended process left open, innermost callbacks first."""
        own = {entity for entity, owner in self._entities.items() if owner == process}
        for entity, thread in [each for each in reversed(self._running) if each[0] in own]:
            if thread in self._blocked:
                yield CallUnblocked(t, self._blocked.pop(thread).call, thread)
            del self._running[entity, thread]
            yield CallbackEnded(t, entity, thread)
        for entity in own:
            del self._entities[entity]
            yield EntityGone(t, entity)
