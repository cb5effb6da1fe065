"""The state and the latest events, which a console gets that connects later."""

from __future__ import annotations

from collections import defaultdict, deque
from operator import itemgetter
from typing import TYPE_CHECKING, Any

from .consoles import lines

if TYPE_CHECKING:
    from collections.abc import Callable

Event = tuple[Any, ...]

_LATEST = 20_000
"""The number of events that are kept."""
_CALLS = 1000
"""The most service calls without a reply that are kept."""


class Latest:
    """The latest events as lines, preceded by the state at their beginning. Not thread-safe."""

    def __init__(self) -> None:
        self._count = 0
        self._batches: deque[tuple[list[Event], int, bytes]] = deque()
        self._ongoing = _Ongoing()

    def add(self, events: list[Event], told: bytes) -> None:
        """Add events, of which ``told`` are the lines, and drop the oldest."""
        wanted = self._ongoing.followed
        self._batches.append(([event for event in events if event[0] in wanted], len(events), told))
        self._count += len(events)
        while self._count > _LATEST and len(self._batches) > 1:
            given_up, count, _ = self._batches.popleft()
            self._count -= count
            for event in given_up:
                self._ongoing.follow(event)

    def whole(self) -> tuple[bytes, int]:
        """The lines of state and events, and how many events these are."""
        ongoing = self._ongoing.events()
        return lines(ongoing) + b"".join(batch[2] for batch in self._batches), len(ongoing) + self._count


class _Ongoing:
    """The state after the dropped events: those that began something which has not ended."""

    def __init__(self) -> None:
        self._lasting: dict[Any, Event] = {}
        self._ready: dict[int, Event] = {}
        self._waits: dict[int, Event] = {}
        self._calls: dict[int, Event] = {}
        self._blocked: dict[int, Event] = {}
        self._runs: dict[tuple[int, int], list[Event]] = {}
        """The start, suspension and resumption of running callbacks, by entity and thread."""
        self._positions: dict[tuple[int, int], Event] = {}
        self._suspended: defaultdict[int, list[list[Event]]] = defaultdict(list)
        self._followed: dict[str, Callable[[Event], object]] = {
            **dict.fromkeys(("node", "group", "entity", "executor", "thread"), _kept_in(self._lasting)),
            "entity_gone": self._gone,
            "qos_mismatch": self._mismatch,
            "ready": _kept_in(self._ready),
            "wait_start": _kept_in(self._waits),
            "wait_end": self._wait_ended,
            "called": self._called,
            **dict.fromkeys(("service_reply", "request_lost"), _taken_from(self._calls)),
            "blocked": _kept_in(self._blocked),
            "unblocked": _taken_from(self._blocked),
            **dict.fromkeys(("callback_start", "taken"), self._started),
            "at": self._at,
            "callback_end": self._left,
            "callback_suspend": self._was_suspended,
            "callback_resume": self._resumed,
        }
        self.followed = self._followed.keys()
        """The tags of the events to follow."""

    def follow(self, event: Event) -> None:
        """Follow one of these events."""
        self._followed[event[0]](event)

    def _gone(self, event: Event) -> None:
        self._lasting.pop(event[2], None)
        self._wait_ended(event)

    def _mismatch(self, event: Event) -> None:
        self._lasting[event[2:5]] = event

    def _wait_ended(self, event: Event) -> None:
        self._ready.pop(event[2], None)
        self._waits.pop(event[2], None)

    def _called(self, event: Event) -> None:
        self._calls[event[2]] = event
        if len(self._calls) > _CALLS:
            del self._calls[next(iter(self._calls))]

    def _started(self, event: Event) -> None:
        self._runs[event[2:4]] = [event]

    def _at(self, event: Event) -> None:
        self._positions[event[2:4]] = event

    def _left(self, event: Event) -> list[Event] | None:
        self._positions.pop(event[2:4], None)
        return self._runs.pop(event[2:4], None)

    def _was_suspended(self, event: Event) -> None:
        if run := self._left(event):
            self._suspended[event[2]].append([run[0], event])

    def _resumed(self, event: Event) -> None:
        if suspended := self._suspended[event[2]]:
            self._runs[event[2:4]] = [*suspended.pop(0), event]

    def events(self) -> list[Event]:
        """The events, in order of time."""
        single = self._lasting, self._ready, self._waits, self._calls, self._blocked, self._positions
        several = [*self._runs.values(), *(run for runs in self._suspended.values() for run in runs)]
        every = [event for kept in single for event in kept.values()]
        return sorted((*every, *(event for each in several for event in each)), key=itemgetter(1))


def _kept_in(events: dict[Any, Event]) -> Callable[[Event], None]:
    """Keeps an event by the id that it is about."""

    def keep(event: Event) -> None:
        events[event[2]] = event

    return keep


def _taken_from(events: dict[Any, Event]) -> Callable[[Event], None]:
    """Drops the event that one with the same id has ended."""

    def drop(event: Event) -> None:
        events.pop(event[2], None)

    return drop
