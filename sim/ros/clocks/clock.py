"""rclpy's clocks: views of the run's clock, unless a program sets ROS time itself."""

from collections.abc import Callable
from typing import Any, Protocol, Self, cast
from weakref import WeakValueDictionary

from sim.clock import AutoResetEvent
from sim.ros.clocks.jumps import SOURCE_CHANGES, ClockChange, JumpHandle, JumpThreshold, TimeJump
from sim.ros.exceptions import NotInitializedException
from sim.ros.handle import Handle
from sim.ros.middleware.endpoints import ContextLifetime
from sim.ros.middleware.host import Host, current_host
from sim.ros.middleware.process import current_process
from sim.ros.time.clock_type import ClockType
from sim.ros.time.duration import Duration
from sim.ros.time.time import Time

__all__ = [
    "Clock",
    "ClockChange",
    "ClockEvent",
    "ClockType",
    "JumpHandle",
    "JumpThreshold",
    "ROSClock",
    "TimeJump",
]


class Clock:
    """A clock of one type. Steady time counts from the start of the run, other time from 1970. Thread-safe.

    ``Clock(clock_type=ROS_TIME)`` creates a ROSClock.
    """

    def __new__(cls, *, clock_type: ClockType = ClockType.SYSTEM_TIME) -> Self:
        """Create the clock; TypeError for an invalid type."""
        if not isinstance(clock_type, ClockType):
            raise TypeError("Clock type must be a ClockType enum")
        chosen: type[Any] = ROSClock if clock_type is ClockType.ROS_TIME and cls is Clock else cls
        made: Any = object.__new__(chosen)
        made._clock_type = clock_type
        made._host = current_host()
        made._jump_handles = []
        return cast("Self", made)

    _clock_type: ClockType
    _host: Host
    _jump_handles: list[JumpHandle]

    @property
    def clock_type(self) -> ClockType:
        """The type of this clock."""
        return self._clock_type

    @property
    def handle(self) -> Handle:
        """A handle, as programs pass it to ClockEvent."""
        return Handle(self)

    @property
    def destroyed(self) -> bool:
        """False: a clock is never destroyed."""
        return False

    def destroy(self) -> None:
        """Do nothing: other code may still use the clock."""

    def now(self) -> Time:
        """The present time."""
        self._host.clock.switch_point()
        return self._time_at(self._host.clock.now())

    def _time_at(self, elapsed: int) -> Time:
        """The time of this clock after ``elapsed`` nanoseconds of the run."""
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
        """Call callbacks before and after the clock jumps. Only ROS time can jump.

        Raises:
            ValueError: no callback is given.
        """
        return JumpHandle(
            clock=self, threshold=threshold, pre_callback=pre_callback, post_callback=post_callback
        )

    def sleep_until(self, until: Time, context: ContextLifetime | None = None) -> bool:
        """Sleep until this clock shows a time; False if the context ended before, or the source changed.

        Raises:
            NotInitializedException: the context is not initialised.
            ValueError: the time belongs to another type of clock.
        """
        chosen = current_process().default_context if context is None else context
        if chosen is None or not chosen.ok():
            raise NotInitializedException
        if until.clock_type != self._clock_type:
            raise ValueError("until's clock type does not match this clock's type")
        event = ClockEvent()
        chosen.wake_at_end(event.set)
        changes: list[TimeJump] = []

        def on_jump(jump: TimeJump) -> None:
            if jump.clock_change in SOURCE_CHANGES:
                changes.append(jump)
            if changes or self.now() >= until:
                event.set()

        threshold = JumpThreshold(
            min_forward=Duration(nanoseconds=1), min_backward=None, on_clock_change=True
        )
        with self.create_jump_callback(threshold, post_callback=on_jump):
            if self.now() < until and chosen.ok():
                event.wait_until(self, until)
            else:
                self._host.clock.poll()
        return chosen.ok() and not changes

    def sleep_for(self, rel_time: Duration, context: ContextLifetime | None = None) -> bool:
        """Sleep for a duration of this clock; otherwise as ``sleep_until``."""
        return self.sleep_until(self.now() + rel_time, context)

    def _deadline(self, until: Time) -> int | None:
        """The time of the run's clock at which this clock shows ``until``; None while ROS time is set."""
        return self._host.clock.now() + (until - self.now()).nanoseconds

    def __repr__(self) -> str:
        return f"Clock(clock_type={self._clock_type.name})"


class RosTimeTimer(Protocol):
    """A timer that follows ROS time while that is active. Called with the host's lock held."""

    @property
    def destroyed(self) -> bool:
        """Whether the timer is destroyed."""

    def _begin_on_ros_time(self) -> None:
        """Start a timer that is created while its clock follows ROS time."""

    def _time_credit(self) -> int:
        """Nanoseconds left before the next call when the source changes; 0 if unknown."""

    def _follow_ros_time(self, credit: int) -> None:
        """The clock follows ROS time from now on."""

    def _follow_system_time(self, credit: int) -> None:
        """The clock follows the run's clock again."""

    def _ros_time_set(self) -> None:
        """ROS time was set."""


class ROSClock(Clock):
    """A clock of ROS time, which nodes use by default.

    While ROS time is active, the clock and its timers have the time that was last set (at first 0).
    """

    _override = Time(clock_type=ClockType.ROS_TIME)
    _active = False
    _timers: WeakValueDictionary[int, RosTimeTimer]

    def __new__(cls, *, clock_type: ClockType = ClockType.ROS_TIME) -> Self:  # noqa: ARG004
        """Create a clock of ROS time; as in rclpy, ``clock_type`` is ignored."""
        made = super().__new__(cls, clock_type=ClockType.ROS_TIME)
        made._timers = WeakValueDictionary()
        return made

    @property
    def ros_time_is_active(self) -> bool:
        """Whether the clock shows the time that was set."""
        return self._active

    def now(self) -> Time:
        """The present time, or the one that was set."""
        return self._override if self._active else super().now()

    def set_ros_time_override(self, time: Time) -> None:
        """Set the time that the clock shows while ROS time is active; TypeError if ``time`` is not a Time."""
        if not isinstance(time, Time):
            raise TypeError(f"Time must be specified as rclpy.time.Time. Received type: {type(time)}")
        override = Time(nanoseconds=time.nanoseconds, clock_type=ClockType.ROS_TIME)
        if self._active:
            self._jump(TimeJump(ClockChange.ROS_TIME_NO_CHANGE, override - self._override), True, override)
        else:
            self._override = override

    def _set_ros_time_is_active(self, enabled: bool) -> None:
        if enabled != self._active:
            change = ClockChange.ROS_TIME_ACTIVATED if enabled else ClockChange.ROS_TIME_DEACTIVATED
            self._jump(TimeJump(change, Duration()), enabled, self._override)

    def _attach_timer(self, timer: RosTimeTimer) -> None:
        """Let a new timer follow this clock."""
        with self._host.lock:
            self._timers[id(timer)] = timer
            if self._active:
                timer._begin_on_ros_time()

    def _jump(self, jump: TimeJump, active: bool, override: Time) -> None:
        told = [each for each in self._jump_handles if each.threshold.met_by(jump)]
        for each in told:
            if each.pre_callback is not None:
                each.pre_callback()
        with self._host.lock:
            timers = [each for each in self._timers.values() if not each.destroyed]
            credits_ = [each._time_credit() for each in timers] if active != self._active else []
            self._active, self._override = active, override
            match jump.clock_change:
                case ClockChange.ROS_TIME_ACTIVATED:
                    for timer, credit in zip(timers, credits_, strict=True):
                        timer._follow_ros_time(credit)
                case ClockChange.ROS_TIME_DEACTIVATED:
                    for timer, credit in zip(timers, credits_, strict=True):
                        timer._follow_system_time(credit)
                case _:
                    for timer in timers:
                        timer._ros_time_set()
        for each in told:
            if each.post_callback is not None:
                each.post_callback(jump)

    def _deadline(self, until: Time) -> int | None:
        return None if self._active else super()._deadline(until)


class ClockEvent:
    """A flag for which threads wait until a clock shows a time. Thread-safe."""

    def __init__(self) -> None:
        self._host = current_host()
        self._set = False
        self._waiters: list[AutoResetEvent] = []

    def is_set(self) -> bool:
        """Whether the flag is set."""
        return self._set

    def set(self) -> None:
        """Set the flag, and wake the waiting threads."""
        with self._host.lock:
            self._set = True
            for each in self._waiters:
                each.set()

    def clear(self) -> None:
        """Clear the flag."""
        self._set = False

    def wait_until(self, clock: Clock | Handle, until: Time) -> None:
        """Wait until the flag is set, or ``clock`` shows ``until``.

        Active ROS time does not end the wait: the code that sets ROS time has to set the flag.
        """
        with self._host.lock:
            if self._set:
                return
            signal = self._host.clock.auto_reset_event()
            self._waiters.append(signal)
            owner: Clock = clock.owner if isinstance(clock, Handle) else clock
            deadline = owner._deadline(until)
        try:
            signal.wait(deadline)
        finally:
            with self._host.lock:
                self._waiters.remove(signal)

    wait_until_steady = wait_until_system = wait_until_ros = wait_until
