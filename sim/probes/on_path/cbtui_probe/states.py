"""The state that the probe keeps on rclpy's objects."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from .recorder import now

if TYPE_CHECKING:
    from collections.abc import Callable

    from .recorder import Recorder

STATE = "_cbtui"
"""The attribute of rclpy's entities, nodes, publishers and groups that holds the probe's own state."""


def state_of(thing: object) -> Any:
    """The probe's state of one of rclpy's objects; None if it has none."""
    return getattr(thing, STATE, None)


class WatchedEntity:
    """The probe's state of one entity: its id, and whether it waits."""

    def __init__(self, kind: str) -> None:
        self.kind = kind
        self.number = 0
        self.due = 0
        """When a timer is due next, or when a guard condition was triggered, in nanoseconds of the monotonic
        clock; 0: not known, or not triggered."""
        self.period = 0
        """A timer's period in nanoseconds, kept since asking rclpy costs more."""
        self.wait: tuple[str, int, bool] | None = None
        """The reason for which it waits, the entity that holds it up, and whether no worker is free; None: it
        does not wait."""
        self._since = 0
        self.made: Callable[[], Any] = nothing
        """Returns rclpy's object; None before its creation and after its destruction."""

    def waits(self, recorder: Recorder, since: int, wait: tuple[str, int, bool]) -> None:
        """Record why it does not run, if that is new; ``since`` is when it became ready, as far as known."""
        if self.wait is None:
            self._since = since
            recorder.put("ready", now(), self.number, 1, 0)
        if self.wait != wait:
            self.wait = wait
            recorder.put("wait_start", now(), self.number, self._since, *wait)

    def waits_no_more(self, recorder: Recorder) -> None:
        """Record that it no longer waits: it runs, or what it was ready for is gone."""
        if self.wait is not None:
            self.wait = None
            recorder.put("wait_end", now(), self.number)


def nothing() -> None:
    """Stand for an object of rclpy's that is not there."""
