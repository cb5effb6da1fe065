"""Full blocks of a store, put by in a spill, with what each begins with at hand."""

from array import array
from collections.abc import Callable
from typing import Generic, TypeVar

from sim.trace.storage.spill import Spill

Block = TypeVar("Block")


class Blocks(Generic[Block]):
    """Blocks in order; ``firsts`` is the time, or other key, with which each begins."""

    __slots__ = (
        "_decode",
        "_encode",
        "_latest",
        "_lengths",
        "_number",
        "_places",
        "_spill",
        "_swelling",
        "firsts",
    )

    def __init__(
        self,
        spill: Spill,
        encode: Callable[[Block], bytes],
        decode: Callable[[bytes], Block],
        swelling: int = 1,
    ) -> None:
        self._swelling = swelling
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
        block = self._spill.look_up(place, length, self._decode, self._swelling)
        self._number, self._latest = number, block
        return block

    def push(self, first: int, block: Block) -> None:
        """Add a block behind the others."""
        self.firsts.append(first)
        data = self._encode(block)
        self._places.append(self._spill.put(data))
        self._lengths.append(len(data))

    def pop(self) -> Block:
        """Take the last block out."""
        block = self[len(self) - 1]
        self._latest = None
        self._spill.forget(self._places.pop())
        self._lengths.pop()
        self.firsts.pop()
        return block

    def save(self, number: int, block: Block) -> None:
        """Keep a change to a block that did not change its length."""
        self._spill.replace(self._places[number], self._encode(block))
