"""Handles, by which rclpy programs keep an entity alive while they use it."""

from typing import Any, Self

from sim.ros.exceptions import InvalidHandle

DESTROYED = "cannot use Destroyable because destruction was requested"
"""rclpy's message when a destroyed entity is used."""


class Handle:
    """A handle of ``owner``, which has ``destroyed`` and ``destroy()``; in rclpy it is a C++ object.

    As a context manager it requires that the owner is not destroyed. An owner that is destroyed while handles
    are entered counts as alive until the last one exits.

    Raises:
        InvalidHandle: on entering, if the owner is destroyed.
    """

    def __init__(self, owner: Any) -> None:
        self.owner = owner
        """The entity, node, context or clock of this handle."""

    @property
    def pointer(self) -> int:
        """A number that identifies the owner among all living objects."""
        return id(self.owner)

    def destroy_when_not_in_use(self) -> None:
        """Destroy the owner."""
        self.owner.destroy()

    def __enter__(self) -> Self:
        uses = self._uses()
        if self.owner.destroyed and uses == 0:
            raise InvalidHandle(DESTROYED)
        vars(self.owner)["_handle_uses"] = uses + 1
        return self

    def __exit__(self, *_error: object) -> None:
        vars(self.owner)["_handle_uses"] = self._uses() - 1

    def _uses(self) -> int:
        uses: int = vars(self.owner).get("_handle_uses", 0)
        return uses

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Handle) and self.owner is other.owner

    def __hash__(self) -> int:
        return id(self.owner)
