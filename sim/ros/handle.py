"""Handles: what rclpy programs hold to keep an entity alive while they use it."""

from __future__ import annotations

from typing import Any, Protocol, Self

from sim.ros.exceptions import InvalidHandle

DESTROYED = "cannot use Destroyable because destruction was requested"
"""What is told of the use of something that was destroyed."""


class Destroyable(Protocol):
    """Something that can be destroyed, and tells whether it was."""

    @property
    def destroyed(self) -> bool:
        """Whether it was destroyed."""

    def destroy(self) -> None:
        """Destroy it."""


class Handle:
    """Stands for what lies below an entity in rclpy; as a context manager it demands that it is alive.

    An entity that is destroyed while it is used counts as alive until it is used no more.

    Raises:
        InvalidHandle: on entering, if the entity was destroyed.
    """

    def __init__(self, owner: Destroyable) -> None:
        self._owner = owner

    @property
    def owner(self) -> Any:
        """What it is the handle of."""
        return self._owner

    @property
    def pointer(self) -> int:
        """A number that no other living entity has."""
        return id(self._owner)

    def destroy_when_not_in_use(self) -> None:
        """Destroy the entity."""
        self._owner.destroy()

    def __enter__(self) -> Self:
        uses = self._uses()
        if self._owner.destroyed and uses == 0:
            raise InvalidHandle(DESTROYED)
        vars(self._owner)["_handle_uses"] = uses + 1
        return self

    def __exit__(self, *_error: object) -> None:
        vars(self._owner)["_handle_uses"] = self._uses() - 1

    def _uses(self) -> int:
        uses: int = vars(self._owner).get("_handle_uses", 0)
        return uses

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Handle) and self._owner is other._owner

    def __hash__(self) -> int:
        return id(self._owner)
