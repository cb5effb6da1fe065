"""A table of integers; the older rows are kept in a temporary file."""

from array import array
from bisect import bisect_left, bisect_right
from collections.abc import Iterator, Sequence
from typing import overload

from sim.trace.storage.spill_file import SpillFile
from sim.trace.storage.spilled_blocks import SpilledBlocks

_LARGEST = 2**63 - 1
"""The largest number that a cell holds."""


class IntegerTable:
    """Rows of ``width`` 64-bit integers each, addressed by row number.

    Searches use the first column, which has to ascend; ``add`` keeps it so. The newest one or two blocks stay
    in memory, so that a row that comes a little late is inserted there, and more of them after an insertion
    far back.
    """

    __slots__ = ("_blocks", "_cells", "_full", "_rows_in_block", "_spilled", "_tail", "_width")

    def __init__(self, spill: SpillFile, width: int) -> None:
        self._width = width
        self._rows_in_block = spill.entries
        self._cells = spill.entries * width
        self._full = 2 * self._cells
        self._spilled = 0
        self._tail = array("q")
        self._blocks: SpilledBlocks[array[int]] = SpilledBlocks(spill, _packed, _unpacked)

    def __len__(self) -> int:
        return self._spilled + len(self._tail) // self._width

    def append(self, row: list[int]) -> int:
        """Append a row and return its number."""
        tail = self._tail
        number = self._spilled + len(tail) // self._width
        _put(row, tail)
        if len(tail) >= self._full:
            self._spill_oldest()
        return number

    def add(self, row: list[int]) -> None:
        """Insert a row by its first cell, behind rows with the same one."""
        tail = self._tail
        if not tail or tail[-self._width] <= row[0]:
            _put(row, tail)
            if len(tail) >= self._full:
                self._spill_oldest()
        else:
            self.insert(self.until(row[0]), row)

    def insert(self, place: int, row: list[int]) -> None:
        """Insert a row in front of another one; expensive if that one is old."""
        while place < self._spilled:
            self._tail[0:0] = self._blocks.pop()
            self._spilled -= self._rows_in_block
        cell = (place - self._spilled) * self._width
        cells = array("q")
        _put(row, cells)
        # These blocks stay in memory until newer rows come: the next row is often as late.
        self._tail[cell:cell] = cells

    def row(self, number: int) -> "array[int]":
        """The cells of a row."""
        width = self._width
        place = number - self._spilled
        if place >= 0:
            return self._tail[place * width : (place + 1) * width]
        block, place = divmod(number, self._rows_in_block)
        return self._blocks[block][place * width : (place + 1) * width]

    def last(self, column: int) -> int:
        """A cell of the last row."""
        return self._tail[column - self._width]

    def cell(self, number: int, column: int) -> int:
        """One cell of a row."""
        place = number - self._spilled
        if place >= 0:
            return self._tail[place * self._width + column]
        block, place = divmod(number, self._rows_in_block)
        return self._blocks[block][place * self._width + column]

    def change(self, number: int, column: int, value: int) -> None:
        """Set a cell."""
        place = number - self._spilled
        if place >= 0:
            self._tail[place * self._width + column] = value
            return
        block, cell = self._found(number)
        block[cell + column] = value
        self._blocks.save(number // self._rows_in_block, block)

    def until(self, key: int) -> int:
        """How many rows begin with ``key`` or less."""
        if not self._spilled or key >= self._tail[0]:
            return self._spilled + bisect_right(self._firsts(self._tail), key, key=self._tail.__getitem__)
        number = bisect_right(self._blocks.firsts, key) - 1
        if number < 0:
            return 0
        block = self._blocks[number]
        return number * self._rows_in_block + bisect_right(self._firsts(block), key, key=block.__getitem__)

    def before(self, key: int) -> int:
        """How many rows begin with less than ``key``."""
        if not self._spilled or key > self._tail[0]:
            return self._spilled + bisect_left(self._firsts(self._tail), key, key=self._tail.__getitem__)
        number = bisect_left(self._blocks.firsts, key) - 1
        if number < 0:
            return 0
        block = self._blocks[number]
        return number * self._rows_in_block + bisect_left(self._firsts(block), key, key=block.__getitem__)

    def find(self, key: int) -> int | None:
        """The last row that begins with ``key``; None if no row does."""
        place = self.until(key) - 1
        return place if place >= 0 and self.cell(place, 0) == key else None

    def newest(self, column: int, count: int) -> "array[int]":
        """The cells of a column in the last ``count`` rows, at most those of one block."""
        count = min(count, self._rows_in_block) * self._width
        return self._tail[max(0, len(self._tail) - count) + column :: self._width]

    def column(self, column: int, rows: range) -> "TableColumn":
        """The cells of a column in some rows, read on access."""
        return TableColumn(self, column, rows)

    def chunks(self, column: int, rows: range) -> Iterator["array[int]"]:
        """The cells of a column in consecutive rows, block by block."""
        start = rows.start
        while start < rows.stop:
            block, cell = self._found(start)
            wanted = (rows.stop - start) * self._width
            found = block[cell + column : cell + wanted : self._width]
            yield found
            start += len(found)

    def _firsts(self, block: "array[int]") -> range:
        return range(0, len(block), self._width)

    def _found(self, number: int) -> "tuple[array[int], int]":
        """The block of a row, and the offset of the row in it."""
        if number >= self._spilled:
            return self._tail, (number - self._spilled) * self._width
        block, place = divmod(number, self._rows_in_block)
        return self._blocks[block], place * self._width

    def _spill_oldest(self) -> None:
        block = self._tail[: self._cells]
        del self._tail[: self._cells]
        self._blocks.push(block[0], block)
        self._spilled += self._rows_in_block


class TableColumn(Sequence[int]):
    """One column of some rows of a table."""

    __slots__ = ("_column", "_rows", "_table")

    def __init__(self, table: IntegerTable, column: int, rows: range) -> None:
        self._table = table
        self._column = column
        self._rows = rows

    def __len__(self) -> int:
        return len(self._rows)

    @overload
    def __getitem__(self, place: int) -> int: ...
    @overload
    def __getitem__(self, place: slice) -> "TableColumn": ...
    def __getitem__(self, place: int | slice) -> "int | TableColumn":
        if isinstance(place, slice):
            return TableColumn(self._table, self._column, self._rows[place])
        return self._table.cell(self._rows[place], self._column)

    def __iter__(self) -> Iterator[int]:
        if self._rows.step != 1:
            yield from (self._table.cell(row, self._column) for row in self._rows)
            return
        for chunk in self._table.chunks(self._column, self._rows):
            yield from chunk


def _packed(block: "array[int]") -> bytes:
    return block.tobytes()


def _unpacked(data: bytes) -> "array[int]":
    block = array("q")
    block.frombytes(data)
    return block


def _put(row: list[int], cells: "array[int]") -> None:
    """Append a row; a number beyond 64 bits, as damaged files have them, is clamped."""
    try:
        cells.fromlist(row)
    except OverflowError:
        cells.fromlist([max(-_LARGEST - 1, min(_LARGEST, number)) for number in row])
