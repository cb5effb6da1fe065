"""Keeps the older blocks of a store in a spill file; the first key of each block stays in memory."""

from array import array
from collections.abc import Callable
from typing import Generic, TypeVar

from sim.trace.storage.spill_file import SpillFile

Block = TypeVar("Block")


class SpilledBlocks(Generic[Block]):
    """A sequence of blocks in ascending order; ``firsts`` has the first key of each, usually a time."""

    __slots__ = (
        "_decode",
        "_encode",
        "_latest",
        "_lengths",
        "_memory_factor",
        "_number",
        "_places",
        "_spill",
        "firsts",
    )

    def __init__(
        self,
        spill: SpillFile,
        encode: Callable[[Block], bytes],
        decode: Callable[[bytes], Block],
        memory_factor: int = 1,
    ) -> None:
        self._memory_factor = memory_factor
        self._spill = spill
        self._encode = encode
        self._decode = decode
        self._places = array("q")
        self._lengths = array("q")
        self._number = -1
        self._latest: Block | None = None
        self.firsts = array("q")

    def __len__(self) -> int:
        return len(self._places)

    def __getitem__(self, number: int) -> Block:
        latest = self._latest
        if number == self._number and latest is not None:
            return latest
        place, length = self._places[number], self._lengths[number]
        block = self._spill.read(place, length, self._decode, self._memory_factor)
        self._number, self._latest = number, block
        return block

    def push(self, first: int, block: Block) -> None:
        """Append a block."""
        self.firsts.append(first)
        data = self._encode(block)
        self._places.append(self._spill.append(data))
        self._lengths.append(len(data))

    def pop(self) -> Block:
        """Remove and return the last block."""
        block = self[len(self) - 1]
        self._latest = None
        self._spill.discard(self._places.pop())
        self._lengths.pop()
        self.firsts.pop()
        return block

    def save(self, number: int, block: Block) -> None:
        """Write back a block that was changed without changing its length."""
        self._spill.replace(self._places[number], self._encode(block))
