"""Jumps of a clock: which jumps matter, and the callbacks for them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum
from typing import TYPE_CHECKING, Self

from sim.ros.time.duration import Duration

if TYPE_CHECKING:
    from sim.ros.clocks.clock import Clock


class ClockChange(IntEnum):
    """Whether a clock's time source changed at a jump."""

    ROS_TIME_NO_CHANGE = 1
    ROS_TIME_ACTIVATED = 2
    ROS_TIME_DEACTIVATED = 3
    SYSTEM_TIME_NO_CHANGE = 4


SOURCE_CHANGES = frozenset((ClockChange.ROS_TIME_ACTIVATED, ClockChange.ROS_TIME_DEACTIVATED))
"""The jumps at which the time source changes."""


class JumpThreshold:
    """Selects jumps: those of at least a length forward or backward, and changes of the time source.

    Raises:
        ValueError: a length has the wrong sign, or no jump is selected.
    """

    def __init__(
        self, *, min_forward: Duration | None, min_backward: Duration | None, on_clock_change: bool = True
    ) -> None:
        if min_forward is not None and min_forward.nanoseconds <= 0:
            raise ValueError("min_forward must be a positive non-zero duration")
        if min_backward is not None and min_backward.nanoseconds >= 0:
            raise ValueError("min_backward must be a negative non-zero duration")
        if min_forward is None and min_backward is None and not on_clock_change:
            raise ValueError("At least one jump threshold must be enabled")
        self.min_forward = min_forward
        self.min_backward = min_backward
        self.on_clock_change = on_clock_change

    def met_by(self, jump: TimeJump) -> bool:
        """Whether the threshold selects a jump."""
        if jump.clock_change in SOURCE_CHANGES:
            return self.on_clock_change
        forward, backward = self.min_forward, self.min_backward
        return (forward is not None and jump.delta >= forward) or (
            backward is not None and jump.delta <= backward
        )


@dataclass(frozen=True, eq=False)
class TimeJump:
    """A jump: whether the time source changed, and the length (0 if the source changed)."""

    clock_change: ClockChange
    delta: Duration

    def __post_init__(self) -> None:
        if not isinstance(self.clock_change, ClockChange):
            raise TypeError("clock_change must be an instance of rclpy.clock.ClockChange")


class JumpHandle:
    """Calls callbacks before and after the jumps of a clock, until it is unregistered.

    Raises:
        ValueError: no callback is given, or it is not callable.
    """

    def __init__(
        self,
        *,
        clock: Clock,
        threshold: JumpThreshold,
        pre_callback: Callable[[], None] | None,
        post_callback: Callable[[TimeJump], None] | None,
    ) -> None:
        if pre_callback is None and post_callback is None:
            raise ValueError("One of pre_callback or post_callback must be callable")
        if pre_callback is not None and not callable(pre_callback):
            raise ValueError("pre_callback must be callable if given")
        if post_callback is not None and not callable(post_callback):
            raise ValueError("One of pre_callback or post_callback must be callable")
        self._clock = clock
        self.threshold = threshold
        self.pre_callback = pre_callback
        self.post_callback = post_callback
        clock._jump_handles.append(self)

    def unregister(self) -> None:
        """Stop calling the callbacks."""
        if self in self._clock._jump_handles:
            self._clock._jump_handles.remove(self)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_error: object) -> None:
        self.unregister()
