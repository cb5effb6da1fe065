"""The clocks that a node reads: views of the run's one clock, unless a program sets ROS time itself."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Self, cast

from sim.ros.clock_jumps import ClockChange, JumpHandle, JumpThreshold, TimeJump
from sim.ros.clock_type import ClockType
from sim.ros.duration import Duration
from sim.ros.exceptions import NotInitializedException
from sim.ros.host import Host, current_host
from sim.ros.time import Time

if TYPE_CHECKING:
    from sim.clock import Signal
    from sim.ros.context import Context

__all__ = [
    "Clock",
    "ClockChange",
    "ClockType",
    "JumpHandle",
    "JumpThreshold",
    "ROSClock",
    "TimeJump",
]


class Clock:
    """A clock of one kind; steady time counts from the run's beginning, the others from 1970. Thread-safe.

    A clock of ROS time is a ROSClock.
    """

    def __new__(cls, *, clock_type: ClockType = ClockType.SYSTEM_TIME) -> Self:
        """Make it; TypeError for what is no type of clock."""
        if not isinstance(clock_type, ClockType):
            raise TypeError("Clock type must be a ClockType enum")
        chosen: type[Any] = ROSClock if clock_type is ClockType.ROS_TIME and cls is Clock else cls
        made: Any = object.__new__(chosen)
        made._clock_type = clock_type
        made._host = current_host()
        made._jump_handles = []
        made._sleepers = []
        made._watched = set()
        return cast("Self", made)

    _clock_type: ClockType
    _host: Host
    _jump_handles: list[JumpHandle]
    _sleepers: list[Signal]
    _watched: set[Context]

    @property
    def clock_type(self) -> ClockType:
        """The kind of this clock."""
        return self._clock_type

    def now(self) -> Time:
        """The time it is."""
        return self._time_at(self._host.clock.now())

    def _time_at(self, elapsed: int) -> Time:
        """The time of this clock at a moment of the run."""
        if self._clock_type != ClockType.STEADY_TIME:
            elapsed += self._host.clock.epoch
        return Time(nanoseconds=elapsed, clock_type=self._clock_type)

    def create_jump_callback(
        self,
        threshold: JumpThreshold,
        *,
        pre_callback: Callable[[], None] | None = None,
        post_callback: Callable[[TimeJump], None] | None = None,
    ) -> JumpHandle:
        """Have callbacks called before and after the clock jumps, which only ROS time can.

        Raises:
            ValueError: there is no callback.
        """
        return JumpHandle(
            clock=self, threshold=threshold, pre_callback=pre_callback, post_callback=post_callback
        )

    def sleep_until(self, until: Time, context: Context | None = None) -> bool:
        """Sleep until a time of this clock has come; False if the context ended first, or the source changed.

        Raises:
            NotInitializedException: the context has not begun.
            ValueError: the time belongs to another kind of clock.
        """
        from sim.ros.utilities import get_default_context

        chosen = get_default_context() if context is None else context
        if not chosen.ok():
            raise NotInitializedException
        if until.clock_type != self._clock_type:
            raise ValueError("until's clock type does not match this clock's type")
        if chosen not in self._watched:
            self._watched.add(chosen)
            chosen.on_shutdown(self._wake_sleepers)
        changes: list[TimeJump] = []
        threshold = JumpThreshold(min_forward=None, min_backward=None, on_clock_change=True)
        with self.create_jump_callback(threshold, post_callback=changes.append):
            while chosen.ok() and not changes and self.now() < until:
                self._sleep_towards(until)
        return chosen.ok() and not changes

    def sleep_for(self, rel_time: Duration, context: Context | None = None) -> bool:
        """Sleep for a length of time of this clock; otherwise as ``sleep_until``."""
        return self.sleep_until(self.now() + rel_time, context)

    def _sleep_towards(self, until: Time) -> None:
        """Sleep until a time, or until the sleepers are woken."""
        with self._host.lock:
            signal = self._host.clock.signal()
            self._sleepers.append(signal)
            deadline = self._deadline(until)
        try:
            signal.wait(deadline)
        finally:
            self._sleepers.remove(signal)

    def _deadline(self, until: Time) -> int | None:
        return self._host.clock.now() + (until - self.now()).nanoseconds

    def _wake_sleepers(self) -> None:
        with self._host.lock:
            for each in self._sleepers:
                each.set()

    def __repr__(self) -> str:
        return f"{type(self).__name__}(clock_type={self._clock_type.name})"


class ROSClock(Clock):
    """The clock that nodes use by default. A program may set its time; timers do not follow that."""

    _override = Time(clock_type=ClockType.ROS_TIME)
    _active = False

    def __new__(cls, *, clock_type: ClockType = ClockType.ROS_TIME) -> Self:  # noqa: ARG004
        """Make it, a clock of ROS time whatever it is told, as rclpy's."""
        return super().__new__(cls, clock_type=ClockType.ROS_TIME)

    @property
    def ros_time_is_active(self) -> bool:
        """Whether the time that was set counts."""
        return self._active

    def now(self) -> Time:
        """The time it is, or the one that was set."""
        return self._override if self._active else super().now()

    def set_ros_time_override(self, time: Time) -> None:
        """Set the time that counts while ROS time is active.

        Raises:
            TypeError: it is no Time.
        """
        if not isinstance(time, Time):
            raise TypeError(f"Time must be specified as rclpy.time.Time. Received type: {type(time)}")
        self._jump(self._active, Time(nanoseconds=time.nanoseconds, clock_type=ClockType.ROS_TIME))

    def _set_ros_time_is_active(self, enabled: bool) -> None:
        self._jump(enabled, self._override)

    def _jump(self, active: bool, override: Time) -> None:
        before = self.now()
        if active == self._active:
            change = ClockChange.ROS_TIME_NO_CHANGE
            after = override if active else before
        else:
            change = ClockChange.ROS_TIME_ACTIVATED if active else ClockChange.ROS_TIME_DEACTIVATED
            after = override if active else super().now()
        jump = TimeJump(change, after - before)
        told = [each for each in self._jump_handles if each.threshold.met_by(jump)]
        for each in told:
            if each.pre_callback is not None:
                each.pre_callback()
        self._active, self._override = active, override
        for each in told:
            if each.post_callback is not None:
                each.post_callback(jump)
        self._wake_sleepers()

    def _deadline(self, until: Time) -> int | None:
        return None if self._active else super()._deadline(until)
