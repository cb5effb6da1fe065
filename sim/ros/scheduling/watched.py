"""What a wait set waits for although no executor serves it: it wakes whoever watches it."""

from __future__ import annotations

from typing import Protocol, Self

from sim.ros.exceptions import InvalidHandle
from sim.ros.handle import DESTROYED


class Watcher(Protocol):
    """Who wants to look again once there is something."""

    def wake(self) -> None:
        """Have it look again. With the host's lock held."""


class BareEntity:
    """Base of the entities without a callback; ``pending`` tells that there is something to take.

    As a context manager it demands that it is alive: InvalidHandle if it was destroyed.
    """

    traced = False
    pending = False
    destroyed = False

    @property
    def pointer(self) -> int:
        """A number that no other living entity has."""
        return id(self)

    def look(self, watcher: Watcher, now: int) -> bool:
        """Whether it is ready; ``watcher`` is woken when it is so next. With the host's lock held."""
        self._watchers[watcher] = None
        return self.pending

    def next_due(self) -> int | None:
        """When it becomes ready by the mere passing of time; None: by that it never does."""
        return None

    def become_ready(self, since: int) -> None:
        """There is something to take from now on. With the host's lock held."""
        self.pending = True
        watchers = tuple(self._watchers)
        self._watchers.clear()
        for each in watchers:
            each.wake()

    def nothing_left(self) -> None:
        """There is nothing more to take. With the host's lock held."""
        self.pending = False

    def destroy(self) -> None:
        """Take it off the network."""
        self.destroyed = True

    def destroy_when_not_in_use(self) -> None:
        """Destroy it."""
        self.destroy()

    def __enter__(self) -> Self:
        if self.destroyed:
            raise InvalidHandle(DESTROYED)
        return self

    def __exit__(self, *_error: object) -> None:
        """Leave it as it is."""

    @property
    def _watchers(self) -> dict[Watcher, None]:
        watchers: dict[Watcher, None] = self.__dict__.setdefault("_watched_by", {})
        return watchers
