"""Timers, and rates, which sleep until a timer's next tick.

The next due time follows rcl: one period after the last due time; if that is past, later by
whole periods. Missed ticks are dropped.
"""

import inspect
from collections.abc import Callable
from typing import Any

from sim.clock import AutoResetEvent
from sim.ros.clocks.clock import Clock, ROSClock
from sim.ros.clocks.ros_time_schedule import RosTimeSchedule, after_change, next_due
from sim.ros.context.context import Context
from sim.ros.exceptions import RCLError, ROSInterruptException
from sim.ros.scheduling.callback_groups import CallbackGroup
from sim.ros.scheduling.entity import NEVER, Entity, OwnerNode, TakenData
from sim.ros.time.clock_type import ClockType
from sim.ros.time.time import Time
from sim.trace.events import EntityKind


class TimerInfo:
    """The expected and the actual time of a timer's call."""

    def __init__(
        self,
        *,
        expected_call_time: int = 0,
        actual_call_time: int = 0,
        clock_type: ClockType = ClockType.SYSTEM_TIME,
    ) -> None:
        self._expected_call_time = Time(nanoseconds=expected_call_time, clock_type=clock_type)
        self._actual_call_time = Time(nanoseconds=actual_call_time, clock_type=clock_type)

    @property
    def expected_call_time(self) -> Time:
        """When the call was due."""
        return self._expected_call_time

    @property
    def actual_call_time(self) -> Time:
        """When the call happened."""
        return self._actual_call_time


class Timer(Entity):
    """Calls its callback every ``timer_period_ns`` nanoseconds, first one period after its creation.

    In some releases, a callback with a parameter annotated as TimerInfo gets a TimerInfo.

    The methods of a destroyed timer raise InvalidHandle.

    Raises:
        RCLError: the period is negative.
    """

    kind = EntityKind.TIMER
    rank = 0

    def __init__(
        self,
        node: OwnerNode,
        timer_period_ns: int,
        callback: Callable[..., Any] | None,
        callback_group: CallbackGroup,
        clock: Clock,
        *,
        autostart: bool = True,
    ) -> None:
        if timer_period_ns < 0:
            raise RCLError("failed to create timer: timer period must be non-negative")
        super().__init__(node, "", callback_group)
        self._host = node.context.host
        self.callback = callback
        self.clock = clock
        self.period = timer_period_ns
        self._last_call = self._host.clock.now()
        self._canceled = True
        self._ros_schedule: RosTimeSchedule | None = None
        if isinstance(clock, ROSClock):
            clock._attach_timer(self)
        if autostart:
            self._start()

    @property
    def callback(self) -> Callable[..., Any] | None:
        """The function that is called when the timer is due."""
        return self._callback

    @callback.setter
    def callback(self, value: Callable[..., Any] | None) -> None:
        self._info_parameter = _info_parameter(value) if self._host.profile.gives_timer_info else None
        self._callback = value

    @property
    def timer_period_ns(self) -> int:
        """The period in nanoseconds; setting it keeps the present due time."""
        return self.period

    @timer_period_ns.setter
    def timer_period_ns(self, value: int) -> None:
        if value < 0:
            raise ValueError("timer period must be non-negative")
        self.period = int(value)

    def cancel(self) -> None:
        """Stop the timer until ``reset``."""
        self.require_alive()
        with self._host.lock:
            self._canceled = True
            self.become_idle()
            self.node.context.probe.timer_cancelled(self)

    def reset(self) -> None:
        """Restart the timer, cancelled or not: it is due one period from now."""
        self.require_alive()
        with self._host.lock:
            self.reset_unheard = True
            if self._canceled:
                self.node.context.probe.timer_reset(self)
            self._start()

    def _start(self) -> None:
        with self._host.lock:
            self._canceled = False
            self.become_idle()
            if self._ros_schedule is not None:
                self._ros_schedule.due = self.clock.now().nanoseconds + self.period
                self._check_ros_time()
                return
            self.due = self._host.clock.now() + self.period
            self.node._agenda.timer_set(self)

    def is_canceled(self) -> bool:
        """Whether the timer is cancelled."""
        self.require_alive()
        return self._canceled

    def is_ready(self) -> bool:
        """Whether the timer is due."""
        self.require_alive()
        return self.still_ready(self._host.clock.now())

    def time_until_next_call(self) -> int | None:
        """Nanoseconds until the timer is due, negative if it is late; None while it is cancelled."""
        self.require_alive()
        if self._canceled:
            return None
        if self._ros_schedule is not None:
            return self._ros_schedule.due - self.clock.now().nanoseconds
        return self.due - self._host.clock.now()

    def time_since_last_call(self) -> int:
        """Nanoseconds since the last call, or since the creation."""
        self.require_alive()
        if self._ros_schedule is not None:
            return self.clock.now().nanoseconds - self._ros_schedule.last_call
        return self._host.clock.now() - self._last_call

    def ready_at(self, now: int) -> bool:
        """Whether the timer is due."""
        return self.still_ready(now)

    def falls_due(self, due: int) -> bool:
        """Whether the timer still becomes ready at ``due``."""
        return self.due == due and not (self.pending or self.destroyed or self._canceled)

    def still_ready(self, now: int) -> bool:
        """Whether the timer is due, and neither cancelled nor destroyed."""
        return not (self._canceled or self.destroyed) and self.due <= now

    def take(self, now: int) -> TakenData | None:
        """Count this call, and set the next due time.

        A timer that was reset while it waited for its turn is still called, one period too early.
        """
        if self._canceled or self.destroyed:
            if self.destroyed or self._is_skipped():
                return None
            self.stuck = self.handed_out = True
            return TakenData(_CANCELLED, 0, 0, 0)
        late = max(now - self.due, 0)
        if self._ros_schedule is not None:
            return TakenData(self._take_of_ros_time(self._ros_schedule), 0, late, 0)
        info = None if self._info_parameter is None else self._info(now)
        self.due = next_due(self.due, self.period, now)
        self._last_call = now
        self.become_idle()
        self.node._agenda.timer_set(self)
        return TakenData(info, 0, late, 0)

    def _is_skipped(self) -> bool:
        """Whether a timer that was cancelled after it was found due is skipped without an error."""
        executor = self.node._agenda.executor
        asks_groups = executor is not None and executor._runner.asks_groups
        return self._host.profile.skips_cancelled_timers or not asks_groups

    # While its clock follows ROS time; with the host's lock held

    def _time_credit(self) -> int:
        """Nanoseconds left before the next call when the clock's source changes; 0 if unknown."""
        schedule = self._ros_schedule
        if schedule is None:
            return self.due - self._host.clock.now()
        now = self.clock.now().nanoseconds
        return schedule.credit if now == 0 else schedule.due - now

    def _begin_on_ros_time(self) -> None:
        """Start a timer that is created while its clock follows ROS time."""
        now = self.clock.now().nanoseconds
        self._ros_schedule = RosTimeSchedule(now + self.period, now)

    def _follow_ros_time(self, credit: int) -> None:
        """The clock follows ROS time from now on."""
        epoch = self._host.clock.epoch
        before = RosTimeSchedule(epoch + self.due, epoch + self._last_call)
        self._ros_schedule = after_change(before, self.clock.now().nanoseconds, self.period, credit)
        self._check_ros_time()

    def _follow_system_time(self, credit: int) -> None:
        """The clock follows the run's clock again."""
        schedule, self._ros_schedule = self._ros_schedule, None
        if schedule is None:
            return
        clock = self._host.clock
        now = clock.now()
        schedule = after_change(schedule, clock.epoch + now, self.period, credit)
        self.become_idle()
        self.due = max(schedule.due - clock.epoch, now)
        self._last_call = max(schedule.last_call - clock.epoch, 0)
        if not self._canceled:
            self.node._agenda.timer_set(self)

    def _ros_time_set(self) -> None:
        """ROS time was set."""
        if self._ros_schedule is not None:
            self._ros_schedule.time_set(self.clock.now().nanoseconds, self.period)
            self._check_ros_time()

    def _check_ros_time(self) -> None:
        """Become ready or idle by the ROS time schedule."""
        schedule = self._ros_schedule
        if schedule is None or self._canceled or schedule.due > self.clock.now().nanoseconds:
            self.due = NEVER  # until ROS time is set
            self.become_idle()
        elif not self.pending:
            self.due = self._host.clock.now()
            self.become_ready(self.due)

    def _take_of_ros_time(self, schedule: RosTimeSchedule) -> TimerInfo | None:
        now = self.clock.now().nanoseconds
        info = None
        if self._info_parameter is not None:
            info = TimerInfo(
                expected_call_time=schedule.due, actual_call_time=now, clock_type=self.clock.clock_type
            )
        schedule.called(now, self.period)
        self.become_idle()
        self._check_ros_time()
        return info

    def invoke(self, taken: TakenData) -> Any:
        """Run the callback.

        Raises:
            TypeError, UnboundLocalError: there is no callback.
            RCLError: the timer was cancelled after it was found due.
        """
        if taken.data is _CANCELLED:
            raise RCLError("failed to call timer: timer is canceled")
        if self._callback is None and self._host.profile.gives_timer_info:
            raise UnboundLocalError(
                "cannot access local variable 'arg_name' where it is not associated with a value"
            )
        if self._info_parameter is None:
            return self._callback()  # type: ignore[misc]
        return self._callback(**{self._info_parameter: taken.data})  # type: ignore[misc]

    def _info(self, now: int) -> TimerInfo:
        return TimerInfo(
            expected_call_time=self.clock._time_at(self.due).nanoseconds,
            actual_call_time=self.clock._time_at(now).nanoseconds,
            clock_type=self.clock.clock_type,
        )


def _info_parameter(callback: Callable[..., Any] | None) -> str | None:
    """The name of the parameter by which a callback asks for a TimerInfo."""
    if callback is None:
        return None
    try:
        parameters = inspect.signature(callback).parameters.values()
    except (TypeError, ValueError):  # not callable, or a function in C without a signature
        return None
    return next((each.name for each in parameters if each.annotation is TimerInfo), None)


_CANCELLED = object()
"""The data taken from a timer that was cancelled meanwhile."""


class Rate:
    """Sleeps until the next tick of its timer. Another thread has to spin the timer's node.

    A tick during which no thread sleeps ends the next sleep at once. Thread-safe.
    """

    def __init__(self, timer: Timer, *, context: Context) -> None:
        self._context = context
        self._host = context.host
        self._sleepers: list[AutoResetEvent] = []
        self._ticked = False
        self._destroyed = False
        self._timer = timer
        timer.callback = self.tick
        context.wake_at_end(self._let_all_go)

    def tick(self) -> None:
        """The timer's callback: wake the sleeping threads."""
        with self._host.lock:
            self._ticked = not self._sleepers
            self._let_all_go()

    def sleep(self) -> None:
        """Sleep until the timer's next tick.

        Raises:
            RuntimeError: the rate was destroyed.
            ROSInterruptException: the context ended.
        """
        with self._host.lock:
            if not self._context.ok():
                raise ROSInterruptException
            if self._destroyed:
                raise RuntimeError("Rate cannot sleep because it has been destroyed")
            if self._ticked:
                self._ticked = False
                return
            tick = self._host.clock.auto_reset_event()
            self._sleepers.append(tick)
        if self._context.ok():  # a signal may just have ended it
            tick.wait(None)
        if not self._context.ok():
            raise ROSInterruptException

    def destroy(self) -> None:
        """Wake the sleeping threads; ``sleep`` raises from now on."""
        self._destroyed = True
        self._let_all_go()

    def _let_all_go(self) -> None:
        with self._host.lock:
            sleepers, self._sleepers = self._sleepers, []
            for each in sleepers:
                each.set()
