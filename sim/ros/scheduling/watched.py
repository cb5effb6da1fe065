"""Entities that no executor serves; they wake the wait sets that watch them."""

from typing import Protocol, Self

from sim.ros.exceptions import InvalidHandle
from sim.ros.handle import DESTROYED


class Watcher(Protocol):
    """An executor or wait set that checks again once an entity is ready."""

    def wake(self) -> None:
        """Make the watcher check again. Called with the host's lock held."""


class BareEntity:
    """Base of the entities without a callback; ``pending``: the entity has something to take.

    As a context manager it raises InvalidHandle if it was destroyed.
    """

    traced = False
    pending = False
    destroyed = False

    @property
    def pointer(self) -> int:
        """A number that identifies the entity among all living objects."""
        return id(self)

    def check(self, watcher: Watcher, now: int) -> bool:
        """Whether the entity is ready; ``watcher`` is woken at the next time. Called with the host's lock."""
        self._watchers[watcher] = None
        return self.pending

    def next_due(self) -> int | None:
        """When the entity becomes ready by time alone; None: never."""
        return None

    def become_ready(self, since: int) -> None:
        """There is something to take from now on. Called with the host's lock held."""
        self.pending = True
        watchers = tuple(self._watchers)
        self._watchers.clear()
        for each in watchers:
            each.wake()

    def become_idle(self) -> None:
        """There is nothing more to take. Called with the host's lock held."""
        self.pending = False

    def destroy(self) -> None:
        """Mark the entity as destroyed."""
        self.destroyed = True

    def destroy_when_not_in_use(self) -> None:
        """Destroy the entity."""
        self.destroy()

    def __enter__(self) -> Self:
        if self.destroyed:
            raise InvalidHandle(DESTROYED)
        return self

    def __exit__(self, *_error: object) -> None:
        """Do nothing."""

    @property
    def _watchers(self) -> dict[Watcher, None]:
        watchers: dict[Watcher, None] = self.__dict__.setdefault("_watched_by", {})
        return watchers
