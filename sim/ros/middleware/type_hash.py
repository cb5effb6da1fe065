"""Hashes of message types, with which ROS 2 checks that two programs use the same type."""

from dataclasses import dataclass
from typing import ClassVar


@dataclass(unsafe_hash=True)
class TypeHash:
    """A hash, and the version of its algorithm; a version of -1 means an unknown hash."""

    _TYPE_HASH_SIZE: ClassVar[int] = 32

    version: int = -1
    value: bytes = bytes(_TYPE_HASH_SIZE)

    def __str__(self) -> str:
        if self.version <= 0 or len(self.value) != self._TYPE_HASH_SIZE:
            return "INVALID"
        return f"RIHS{self.version:02}_{self.value.hex()}"
