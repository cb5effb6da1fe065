"""What stands in a wait-for graph: callbacks on threads, suspended ones, and what is in their way."""

from dataclasses import dataclass
from typing import TypeAlias

from sim.diagnosis.rule import WaitedFor
from sim.diagnosis.words import who
from sim.trace.events import EntityId, ThreadId
from sim.trace.model import Nanoseconds
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
    """What a callback waits for, with a clause; it ends if one of ``by`` continues.

    ``wanted`` is the service, or a ``WaitedFor``; ``needs_worker``: whether a thread is missing; ``group`` is
    the group that has to admit it, "" for none; ``name`` is the name of what is wanted, if it has one of its
    own. ``since`` is when it began to be in the way, 0 if it was there before the wait for it.
    """

    wanted: str
    text: str
    by: tuple[Waiter, ...]
    needs_worker: bool = False
    group: str = ""
    name: str = ""
    since: Nanoseconds = 0

    @property
    def kind(self) -> WaitedFor:
        """The kind of ``wanted``."""
        return self.wanted if isinstance(self.wanted, WaitedFor) else WaitedFor.REPLY

    @property
    def steps(self) -> tuple[str, ...]:
        """The steps from the callback to the one that blocks it: ``/add``, ``group A``."""
        by = "a thread" if self.needs_worker else self.group
        return tuple(filter(None, (self.name or self.wanted, by)))


@dataclass(frozen=True, slots=True)
class StuckCallback:
    """A callback that waits for what cannot come: since when, for what, and until when (0: for ever)."""

    waiter: Waiter
    entity: EntityId
    since: Nanoseconds
    obstacle: Obstacle
    until: Nanoseconds = 0

    def name(self, timeline: Timeline) -> str:
        """The name of the callback, or of the thread that runs none."""
        return who(self.entity, timeline) if self.entity else thread_name(self.waiter, timeline)


def thread_name(waiter: Waiter, timeline: Timeline) -> str:
    """Return the name of the thread on which something waits; "a thread" if it is not known."""
    known = timeline.threads.get(waiter.thread) if isinstance(waiter, OnThread) else None
    return "a thread" if known is None else known.name
