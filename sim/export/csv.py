"""Writes the calls of a run as comma-separated values, a row a call (RFC 4180)."""

import csv
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any, TextIO

from sim.export.open_calls import CallSegment, OpenCalls
from sim.export.reorder_buffer import ReorderBuffer
from sim.export.texts import cell, seconds
from sim.export.waits_of_calls import WaitsOfCalls
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
    """Writes a row when a call leaves its thread, so rows are in order of their end.

    A coroutine's call that was suspended has several rows, the first with its wait. ``wait_s`` is how long
    the callback, or its message, had waited before it ran, ``age_s`` the age of its message then, or how
    late its timer was.
    Calls that never end come last and have neither end nor duration. Open the file with ``newline=""``.
    Memory does not grow with the length of the run. Not thread-safe.
    """

    def __init__(self, file: TextIO) -> None:
        self._rows = csv.writer(file)
        self._rows.writerow(COLUMNS)
        self._reordered = ReorderBuffer()
        self._participants = Participants()
        self._open_calls = OpenCalls()
        self._waits = WaitsOfCalls()
        self._entity_cells = cache(self._make_cells)
        self._handlers: dict[type, Callable[[Any], object]] = {
            ev.ProcessAppeared: self._participants.add_process,
            ev.ThreadAppeared: self._participants.add_thread,
            ev.GroupAppeared: self._participants.add_group,
            ev.EntityAppeared: self._participants.add_entity,
            ev.EntityReady: self._entity_ready,
            ev.MessageDropped: self._waits.lose,
            ev.WaitStarted: self._waits.start,
            ev.WaitEnded: self._waits.end,
            ev.CallbackStarted: self._callback_started,
            ev.CallbackEnded: self._callback_ended,
            ev.CallbackSuspended: self._callback_suspended,
            ev.CallbackResumed: self._open_calls.resume,
            ev.CallbackFailed: self._open_calls.fail,
            ev.EventsLost: self._events_lost,
        }

    def take(self, events: Sequence[AnyEvent]) -> None:
        """Write the calls that end in a batch; the latest stay in the reorder buffer."""
        known = self._handlers
        self._handle_all(self._reordered.take([event for event in events if event.__class__ in known]))

    def finish(self) -> None:
        """Write the rest."""
        self._handle_all(self._reordered.flush())
        for segment in sorted(self._open_calls.running(), key=lambda segment: segment.number):
            self._write(segment, None)

    def _handle_all(self, events: Sequence[AnyEvent]) -> None:
        handlers = self._handlers
        for event in events:
            handlers[event.__class__](event)

    def _entity_ready(self, event: ev.EntityReady) -> None:
        self._reordered.forget(event)
        self._waits.arrive(event)

    def _callback_started(self, event: ev.CallbackStarted) -> None:
        for segment in self._open_calls.ended_unseen(event.thread):
            self._write(segment, event.t)
        self._open_calls.start(event, self._waits.before(event))

    def _callback_ended(self, event: ev.CallbackEnded) -> None:
        left = self._open_calls.finish(event)
        for segment in left:
            self._write(segment, event.t)
        if not left:
            self._open_calls.finish_suspended(event.entity)

    def _callback_suspended(self, event: ev.CallbackSuspended) -> None:
        for segment in self._open_calls.suspend(event):
            self._write(segment, event.t)

    def _events_lost(self, _event: ev.EventsLost) -> None:
        self._open_calls.mark_uncertain()

    def _write(self, segment: CallSegment, end: Nanoseconds | None) -> None:
        callback, kind, entity, group = self._entity_cells(segment.entity)
        thread = self._participants.threads.get(segment.thread)
        self._rows.writerow(
            (
                seconds(segment.start),
                "" if end is None else seconds(end),
                "" if end is None else seconds(end - segment.start),
                seconds(segment.wait),
                callback,
                kind,
                entity,
                group,
                f"thread {segment.thread}" if thread is None else cell(thread.name),
                seconds(segment.age),
                cell(segment.error),
            )
        )

    def _make_cells(self, entity: EntityId) -> tuple[str, str, str, str]:
        known = self._participants.entities.get(entity)
        if known is None:
            return f"callback {entity}", "", "", ""
        group = self._participants.groups.get(known.group)
        letter = "" if group is None else group.letter
        return cell(known.spoken_name), known.kind.value, cell(known.name), letter
