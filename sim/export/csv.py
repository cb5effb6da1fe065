"""Writes the calls of a run as a table, a line for each, for spreadsheets (RFC 4180)."""

import csv
from collections.abc import Callable, Sequence
from typing import Any, TextIO

from sim.export.ordering import InOrder
from sim.export.running import Running, Stretch
from sim.export.texts import cell, seconds
from sim.trace import events as ev
from sim.trace.events import AnyEvent, EntityId
from sim.trace.model import Nanoseconds
from sim.trace.participants import Participants

COLUMNS = (
    "start_s",
    "end_s",
    "duration_s",
    "wait_s",
    "callback",
    "kind",
    "entity",
    "group",
    "thread",
    "age_s",
    "error",
)


class CallTable:
    """Writes a line when a call leaves its thread, so lines stand in order of their end.

    A coroutine's call that was suspended is several lines, the first with its wait. ``wait_s`` is how long
    the callback was ready before it ran, ``age_s`` the age of its message then or how late its timer was.
    Calls that never end come last and have neither end nor duration. The file is to be opened with
    ``newline=""``. Memory does not grow with the length of the run. Not thread-safe.
    """

    def __init__(self, file: TextIO) -> None:
        self._rows = csv.writer(file)
        self._rows.writerow(COLUMNS)
        self._order = InOrder()
        self._participants = Participants()
        self._running = Running()
        self._waiting: dict[EntityId, Nanoseconds] = {}
        self._waited: dict[EntityId, Nanoseconds] = {}
        self._told: dict[EntityId, tuple[str, str, str, str]] = {}
        self._fold: dict[type, Callable[[Any], object]] = {
            ev.ProcessAppeared: self._participants.add_process,
            ev.ThreadAppeared: self._participants.add_thread,
            ev.GroupAppeared: self._participants.add_group,
            ev.EntityAppeared: self._participants.add_entity,
            ev.WaitStarted: self._wait_started,
            ev.WaitEnded: self._wait_ended,
            ev.CallbackStarted: self._callback_started,
            ev.CallbackEnded: self._callback_ended,
            ev.CallbackSuspended: self._callback_suspended,
            ev.CallbackResumed: self._running.resume,
            ev.CallbackFailed: self._running.fail,
            ev.EventsLost: self._events_lost,
        }

    def take(self, events: Sequence[AnyEvent]) -> None:
        """Write the calls that end in a batch; some of them may be written later."""
        known = self._fold
        self._fold_all(self._order.take([event for event in events if event.__class__ in known]))

    def finish(self) -> None:
        """Write the rest."""
        self._fold_all(self._order.rest())
        for stretch in sorted(self._running.left_over(), key=lambda stretch: stretch.number):
            self._write(stretch, None)

    def _fold_all(self, events: Sequence[AnyEvent]) -> None:
        fold = self._fold
        for event in events:
            fold[event.__class__](event)

    def _wait_started(self, event: ev.WaitStarted) -> None:
        self._waiting[event.entity] = event.since

    def _wait_ended(self, event: ev.WaitEnded) -> None:
        since = self._waiting.pop(event.entity, None)
        if since is not None:
            self._waited[event.entity] = event.t - since

    def _callback_started(self, event: ev.CallbackStarted) -> None:
        for stretch in self._running.outdated(event.thread):
            self._write(stretch, event.t)
        self._running.start(event, self._waited.pop(event.entity, 0))

    def _callback_ended(self, event: ev.CallbackEnded) -> None:
        left = self._running.finish(event)
        for stretch in left:
            self._write(stretch, event.t)
        if not left:
            self._running.finish_suspended(event.entity)

    def _callback_suspended(self, event: ev.CallbackSuspended) -> None:
        for stretch in self._running.suspend(event):
            self._write(stretch, event.t)

    def _events_lost(self, _event: ev.EventsLost) -> None:
        self._running.doubt()

    def _write(self, stretch: Stretch, end: Nanoseconds | None) -> None:
        callback, kind, entity, group = self._about(stretch.entity)
        thread = self._participants.threads.get(stretch.thread)
        self._rows.writerow(
            (
                seconds(stretch.start),
                "" if end is None else seconds(end),
                "" if end is None else seconds(end - stretch.start),
                seconds(stretch.wait),
                callback,
                kind,
                entity,
                group,
                f"thread {stretch.thread}" if thread is None else cell(thread.name),
                seconds(stretch.age),
                cell(stretch.error),
            )
        )

    def _about(self, entity: EntityId) -> tuple[str, str, str, str]:
        told = self._told.get(entity)
        if told is None:
            told = self._told[entity] = self._tell(entity)
        return told

    def _tell(self, entity: EntityId) -> tuple[str, str, str, str]:
        known = self._participants.entities.get(entity)
        if known is None:
            return f"callback {entity}", "", "", ""
        group = self._participants.groups.get(known.group)
        letter = "" if group is None else group.letter
        return cell(known.spoken_name), known.kind.value, cell(known.name), letter
