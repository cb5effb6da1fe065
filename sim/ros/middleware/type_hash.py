"""Hashes of message types, with which ROS 2 checks that two programs use the same type."""

from __future__ import annotations


class TypeHash:
    """A hash, and the version of its algorithm; a version of -1 means an unknown hash."""

    _TYPE_HASH_SIZE = 32

    def __init__(self, version: int = -1, value: bytes = bytes(_TYPE_HASH_SIZE)) -> None:
        self.version = version
        self.value = value

    def __eq__(self, other: object) -> bool:
        if isinstance(other, TypeHash):
            return (self.version, self.value) == (other.version, other.value)
        return NotImplemented

    def __hash__(self) -> int:
        return hash((self.version, self.value))

    def __str__(self) -> str:
        if self.version <= 0 or len(self.value) != self._TYPE_HASH_SIZE:
            return "INVALID"
        return f"RIHS{self.version:02}_{self.value.hex()}"

    def __repr__(self) -> str:
        return f"{type(self).__name__}(version={self.version}, value={self.value!r})"
