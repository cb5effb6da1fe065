"""What a console that comes late is told: what began long ago and goes on, and the latest events."""

from __future__ import annotations

from collections import defaultdict, deque
from typing import Any

from .consoles import lines

Event = tuple[Any, ...]

_LATEST = 20_000
"""The number of events that are kept."""
_CALLS = 1000
"""The most service calls without a reply that are kept."""
_LASTING = {"node", "group", "entity", "executor", "thread", "qos_mismatch"}
_RUNNING = {"callback_start", "taken", "callback_end", "callback_suspend", "callback_resume", "at"}
_WAITING = {"ready", "wait_start", "wait_end", "entity_gone"}
_CALLING = {"called", "service_reply", "request_lost", "blocked", "unblocked"}
_FOLLOWED = _LASTING | _RUNNING | _WAITING | _CALLING


class Latest:
    """The latest events, as lines, and before them the state at their beginning. For one thread."""

    def __init__(self) -> None:
        self._count = 0
        self._batches: deque[tuple[list[Event], int, bytes]] = deque()
        self._ongoing = _Ongoing()

    def add(self, events: list[Event], told: bytes) -> None:
        """Keep events, whose lines are ``told``, and give up the oldest ones."""
        self._batches.append(([event for event in events if event[0] in _FOLLOWED], len(events), told))
        self._count += len(events)
        while self._count > _LATEST and len(self._batches) > 1:
            given_up, count, _ = self._batches.popleft()
            self._count -= count
            for event in given_up:
                self._ongoing.follow(event)

    def whole(self) -> tuple[bytes, int]:
        """The lines of all of it, and the number of their events."""
        ongoing = self._ongoing.events()
        return lines(ongoing) + b"".join(batch[2] for batch in self._batches), len(ongoing) + self._count


class _Ongoing:
    """Follows events, and returns those that began something which has not ended."""

    def __init__(self) -> None:
        self._lasting: dict[Any, Event] = {}
        self._waits: defaultdict[int, dict[str, Event]] = defaultdict(dict)
        self._calls: dict[int, Event] = {}
        self._blocked: dict[int, Event] = {}
        self._runs: dict[tuple[int, int], dict[str, Event]] = {}
        """The events of a running callback by their tags, by its entity and thread."""
        self._suspended: defaultdict[int, list[dict[str, Event]]] = defaultdict(list)

    def follow(self, event: Event) -> None:
        """Follow one event."""
        tag, _, subject = event[:3]
        if tag in _RUNNING:
            self._follow_callback(tag, event)
        elif tag in _CALLING:
            self._follow_call(tag, event)
        elif tag in _LASTING:
            self._lasting[event[2:5] if tag == "qos_mismatch" else subject] = event
        elif tag in ("ready", "wait_start"):
            self._waits[subject][tag] = event
        else:
            self._waits.pop(subject, None)
            if tag == "entity_gone":
                self._lasting.pop(subject, None)

    def _follow_callback(self, tag: str, event: Event) -> None:
        entity, place = event[2], event[2:4]
        if tag in ("callback_start", "taken"):
            self._runs[place] = {"start": event}
        elif tag == "at":
            self._runs.get(place, {})[tag] = event
        elif tag == "callback_resume":
            if self._suspended[entity]:
                self._runs[place] = {**self._suspended[entity].pop(0), tag: event}
        else:
            run = self._runs.pop(place, None)
            if tag == "callback_suspend" and run is not None:
                self._suspended[entity].append({"start": run["start"], tag: event})

    def _follow_call(self, tag: str, event: Event) -> None:
        call = event[2]
        if tag == "called":
            self._calls[call] = event
            if len(self._calls) > _CALLS:
                del self._calls[next(iter(self._calls))]
        elif tag == "blocked":
            self._blocked[call] = event
        elif tag == "unblocked":
            self._blocked.pop(call, None)
        else:
            self._calls.pop(call, None)

    def events(self) -> list[Event]:
        """The events, in order of time."""
        several = [*self._waits.values(), *self._runs.values()]
        for each in self._suspended.values():
            several += each
        single = [*self._lasting.values(), *self._calls.values(), *self._blocked.values()]
        return sorted((*single, *(event for each in several for event in each.values())), key=_time_of)


def _time_of(event: Event) -> int:
    return int(event[1])
