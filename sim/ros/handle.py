"""Handles, by which rclpy programs keep an entity alive while they use it."""

from __future__ import annotations

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
        self._owner = owner

    @property
    def owner(self) -> Any:
        """The entity, node or context of this handle."""
        return self._owner

    @property
    def pointer(self) -> int:
        """A number that identifies the owner among all living objects."""
        return id(self._owner)

    def destroy_when_not_in_use(self) -> None:
        """Destroy the owner."""
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
