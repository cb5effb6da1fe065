"""Items in order of time, searched by bisection; older ones are kept in a temporary file."""

from bisect import bisect_left, bisect_right, insort_right
from collections.abc import Callable, Iterator, Sequence
from typing import Any, TypeVar, overload

import msgspec

from sim.trace.lazy import LazySequence, ListLike
from sim.trace.model import Nanoseconds, Window
from sim.trace.storage.spill_file import SpillFile
from sim.trace.storage.spilled_blocks import SpilledBlocks

Item = TypeVar("Item")

ITEMS_IN_BLOCK = 256

_MEMORY_FACTOR = 4
"""Approximate memory of items relative to their encoding."""

_encoder = msgspec.msgpack.Encoder()


class History(ListLike[Item]):
    """Items sorted by the time that ``when`` returns; items of the same time keep their order of arrival.

    ``kind`` is the type of the items: immutable, and one that msgspec encodes. A new item is appended, a late
    one inserted. The newest one or two blocks stay in memory, more after an insertion far back; the others
    are written to the spill file and decoded on access.
    """

    __slots__ = ("_blocks", "_full", "_items_in_block", "_spilled", "_tail", "_when")

    def __init__(
        self,
        when: Callable[[Item], Nanoseconds],
        kind: Any,
        spill: SpillFile,
        items_in_block: int = ITEMS_IN_BLOCK,
    ) -> None:
        self._when = when
        self._items_in_block = min(items_in_block, spill.entries)
        self._full = 2 * self._items_in_block
        self._spilled = 0
        self._tail: list[Item] = []
        self._blocks: SpilledBlocks[list[Item]] = SpilledBlocks(
            spill, _encoder.encode, msgspec.msgpack.Decoder(list[kind]).decode, _MEMORY_FACTOR
        )

    def add(self, item: Item) -> None:
        """Add an item."""
        tail = self._tail
        if tail and self._when(item) < self._when(tail[-1]):
            self._add_late(item)
            return
        tail.append(item)
        if len(tail) >= self._full:
            self._spill_oldest()

    def until(self, at: Nanoseconds) -> int:
        """The number of items at or before ``at``."""
        if not self._spilled or at >= self._when(self._tail[0]):
            return self._spilled + bisect_right(self._tail, at, key=self._when)
        number = bisect_right(self._blocks.firsts, at) - 1
        if number < 0:
            return 0
        return number * self._items_in_block + bisect_right(self._blocks[number], at, key=self._when)

    def before(self, at: Nanoseconds) -> int:
        """The number of items before ``at``."""
        if not self._spilled or at > self._when(self._tail[0]):
            return self._spilled + bisect_left(self._tail, at, key=self._when)
        number = bisect_left(self._blocks.firsts, at) - 1
        if number < 0:
            return 0
        return number * self._items_in_block + bisect_left(self._blocks[number], at, key=self._when)

    def latest(self, at: Nanoseconds) -> Item | None:
        """The last item at or before ``at``."""
        place = self.until(at)
        return self[place - 1] if place else None

    def within(self, window: Window) -> Sequence[Item]:
        """The items in the window."""
        return self._from(range(self.before(window.start), self.before(window.end)))

    def __len__(self) -> int:
        return self._spilled + len(self._tail)

    @overload
    def __getitem__(self, place: int) -> Item: ...
    @overload
    def __getitem__(self, place: slice) -> Sequence[Item]: ...
    def __getitem__(self, place: int | slice) -> Item | Sequence[Item]:
        numbers = range(len(self))
        return (
            LazySequence(numbers[place], self._item)
            if isinstance(place, slice)
            else self._item(numbers[place])
        )

    def __iter__(self) -> Iterator[Item]:
        for start in range(0, self._spilled, self._items_in_block):
            yield from self._from(range(start, start + self._items_in_block))
        yield from self._tail

    def _item(self, number: int) -> Item:
        if number >= self._spilled:
            return self._tail[number - self._spilled]
        block, within = divmod(number, self._items_in_block)
        return self._blocks[block][within]

    def _from(self, numbers: range) -> list[Item]:
        found: list[Item] = []
        start = numbers.start
        while start < min(numbers.stop, self._spilled):
            block, first = divmod(start, self._items_in_block)
            part = self._blocks[block][first : first + numbers.stop - start]
            found += part
            start += len(part)
        if start < numbers.stop:
            found += self._tail[start - self._spilled : numbers.stop - self._spilled]
        return found

    def _add_late(self, item: Item) -> None:
        at = self._when(item)
        while self._spilled and at < self._when(self._tail[0]):
            self._tail[0:0] = self._blocks.pop()
            self._spilled -= self._items_in_block
        # These blocks stay in memory until newer items come: the next item is often as late.
        insort_right(self._tail, item, key=self._when)

    def _spill_oldest(self) -> None:
        block = self._tail[: self._items_in_block]
        del self._tail[: self._items_in_block]
        self._blocks.push(self._when(block[0]), block)
        self._spilled += self._items_in_block
