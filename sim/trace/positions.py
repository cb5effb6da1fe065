"""Where running callbacks were in the program's own code."""

from collections import defaultdict, deque
from collections.abc import Sequence
from typing import TypeAlias

from sim.trace.events import CallbackAt, CallbackSuspended, Doing, EntityId, ThreadId
from sim.trace.lazy import LazySequence
from sim.trace.model import AWAIT, Frame, Nanoseconds, Position, Span, Window
from sim.trace.storage.intervals import IntervalLane, Intervals, RowId, end_or_none
from sim.trace.storage.spill_file import SpillFile

_PositionCells: TypeAlias = tuple[
    Doing, str, tuple[Frame, ...], tuple[str, int], ThreadId, EntityId, str, tuple[str, int], str, bool
]
"""The fields of a position from ``doing`` on; ``until`` is not among them."""
_NO_LOCK = 0, 0, "", ("", 0), "", False


class Positions(Intervals):
    """The positions of all callbacks, by thread and by callback."""

    THREAD, ENTITY, UNTIL, PLACE = range(2, 6)

    def __init__(self, spill: SpillFile) -> None:
        super().__init__(spill, more=4)
        self._numbers: dict[_PositionCells, int] = {}
        self._places: list[_PositionCells] = []
        self._by_thread: defaultdict[ThreadId, IntervalLane] = defaultdict(lambda: IntervalLane(self))
        self._by_entity: defaultdict[EntityId, IntervalLane] = defaultdict(lambda: IntervalLane(self))
        self._awaiting: defaultdict[EntityId, deque[RowId]] = defaultdict(deque)
        self._latest: dict[ThreadId, RowId] = {}
        self.threads: set[ThreadId] = set()
        """The threads of which any is known."""

    def start(self, event: CallbackAt, span: Span | None) -> None:
        """Start an interval in the call that runs on the thread; a sample that came too late is ignored."""
        if span is None or span.entity != event.entity:
            return
        self.finish(event.thread, event.t)
        frames = tuple(Frame(*each) for each in event.frames)
        lock = event.holder, event.keeper, event.lock, event.taken_at, event.taken_by, event.is_left
        place = event.doing, event.call, frames, event.loop, *lock
        row = self.open(event.t, event.thread, event.entity, event.until, self._number(place))
        self._by_thread[event.thread].add(row)
        self.threads.add(event.thread)
        self._by_entity[event.entity].add(row)
        self._latest[event.thread] = row
        if span.end is not None:
            self.finish(event.thread, span.end)

    def finish(self, thread: ThreadId, at: Nanoseconds) -> None:
        """End the interval of a thread."""
        row = self._latest.pop(thread, None)
        if row is not None:
            self.close(row, at)

    def suspend(self, event: CallbackSuspended) -> None:
        """Start the interval of a suspended call, which is on no thread."""
        if event.frames:
            frames = tuple(Frame(*each) for each in event.frames)
            place = Doing.WAITS, AWAIT, frames, ("", 0), *_NO_LOCK
            row = self.open(event.t, 0, event.entity, 0, self._number(place))
            self._by_entity[event.entity].add(row)
            self._awaiting[event.entity].append(row)

    def resume(self, entity: EntityId, at: Nanoseconds) -> None:
        """End the interval of the call that was suspended first."""
        if self._awaiting[entity]:
            self.close(self._awaiting[entity].popleft(), at)

    def _number(self, place: _PositionCells) -> int:
        number = self._numbers.setdefault(place, len(self._places))
        if number == len(self._places):
            self._places.append(place)
        return number

    def of(self, entity: EntityId, window: Window) -> Sequence[Position]:
        """The positions of an entity's callback, in order of start."""
        return LazySequence(self._by_entity[entity].overlapping(window), self._position)

    def on(self, thread: ThreadId, window: Window) -> Sequence[Position]:
        """The positions on a thread, in order of start."""
        return LazySequence(self._by_thread[thread].overlapping(window), self._position)

    def at(self, thread: ThreadId, at: Nanoseconds) -> Position | None:
        """The position of a thread."""
        rows = self._by_thread[thread].covering(at)
        return self._position(rows[-1]) if rows else None

    def _position(self, row: RowId) -> Position:
        start, end, thread, entity, until, number = self.table.row(row)
        return Position(start, end_or_none(end), thread, entity, *self._places[number], until)
