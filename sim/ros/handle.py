"""Handles: what rclpy programs hold to keep an entity alive while they use it."""

from __future__ import annotations

from typing import Protocol, Self

from sim.ros.exceptions import InvalidHandle


class Destroyable(Protocol):
    """Something that can be destroyed, and tells whether it was."""

    @property
    def destroyed(self) -> bool:
        """Whether it was destroyed."""

    def destroy(self) -> None:
        """Destroy it."""


class Handle:
    """Stands for what lies below an entity in rclpy; as a context manager it demands that it is alive.

    Raises:
        InvalidHandle: on entering, if the entity was destroyed.
    """

    def __init__(self, owner: Destroyable) -> None:
        self._owner = owner

    @property
    def pointer(self) -> int:
        """A number that no other living entity has."""
        return id(self._owner)

    def destroy_when_not_in_use(self) -> None:
        """Destroy the entity."""
        self._owner.destroy()

    def __enter__(self) -> Self:
        if self._owner.destroyed:
            raise InvalidHandle("cannot use Destroyable because destruction was requested")
        return self

    def __exit__(self, *_error: object) -> None:
        """Leave the entity as it is."""

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Handle) and self._owner is other._owner

    def __hash__(self) -> int:
        return id(self._owner)
