"""rclpy's ``Time``."""

from __future__ import annotations

from functools import total_ordering
from typing import Any, overload

from sim.ros.time.clock_type import ClockType
from sim.ros.time.duration import Duration

_NANOSECONDS = 1_000_000_000
_LIMIT = 2**63


@total_ordering
class Time:
    """A point in time on one kind of clock, in whole nanoseconds. Immutable, ordered, hashable.

    Comparing times of two kinds of clock raises TypeError. A time equals only times.
    """

    __slots__ = ("_clock_type", "_nanoseconds")

    def __init__(
        self, *, seconds: int | float = 0, nanoseconds: int = 0, clock_type: ClockType = ClockType.SYSTEM_TIME
    ) -> None:
        if not isinstance(clock_type, ClockType):
            raise TypeError("Clock type must be a ClockType enum")
        if seconds < 0:
            raise ValueError("Seconds value must not be negative")
        if nanoseconds < 0:
            raise ValueError("Nanoseconds value must not be negative")
        total = int(seconds * _NANOSECONDS) + int(nanoseconds)
        if total >= _LIMIT:
            raise OverflowError("Total nanoseconds value is too large to store in C time point.")
        self._nanoseconds = total
        self._clock_type = clock_type

    @property
    def nanoseconds(self) -> int:
        """Nanoseconds since the clock's beginning."""
        return self._nanoseconds

    @property
    def clock_type(self) -> ClockType:
        """The kind of clock that this time belongs to."""
        return self._clock_type

    @property
    def _time_handle(self) -> Time:
        """The time itself, by the name that programs hand to ClockEvent."""
        return self

    def seconds_nanoseconds(self) -> tuple[int, int]:
        """Whole seconds, and the remaining nanoseconds."""
        return divmod(self._nanoseconds, _NANOSECONDS)

    def __repr__(self) -> str:
        return f"Time(nanoseconds={self._nanoseconds}, clock_type={self._clock_type.name})"

    def __hash__(self) -> int:
        return hash((self._nanoseconds, self._clock_type))

    def __add__(self, other: Duration) -> Time:
        if isinstance(other, Duration):
            total = self._nanoseconds + other.nanoseconds
            if total >= _LIMIT:
                raise OverflowError("Addition leads to overflow in C storage.")
            return Time(nanoseconds=total, clock_type=self._clock_type)
        return NotImplemented

    __radd__ = __add__

    @overload
    def __sub__(self, other: Time) -> Duration: ...
    @overload
    def __sub__(self, other: Duration) -> Time: ...
    def __sub__(self, other: Time | Duration) -> Time | Duration:
        if isinstance(other, Time):
            return Duration(nanoseconds=self._nanoseconds - self._same_clock(other, "subtract times"))
        if isinstance(other, Duration):
            if other.nanoseconds > self._nanoseconds:
                raise ValueError("Subtraction leads to negative time.")
            return Time(nanoseconds=self._nanoseconds - other.nanoseconds, clock_type=self._clock_type)
        return NotImplemented

    def _same_clock(self, other: Time, action: str) -> int:
        if self._clock_type != other._clock_type:
            raise TypeError(f"Can't {action} with different clock types")
        return other._nanoseconds

    def __eq__(self, other: object) -> bool:
        if isinstance(other, Time):
            return self._nanoseconds == self._same_clock(other, "compare times")
        return NotImplemented

    def __lt__(self, other: Time) -> bool:
        if isinstance(other, Time):
            return self._nanoseconds < self._same_clock(other, "compare times")
        return NotImplemented

    def to_msg(self) -> Any:
        """Convert it to a builtin_interfaces/msg/Time."""
        from sim.interfaces import message

        seconds, nanoseconds = self.seconds_nanoseconds()
        return message("builtin_interfaces", "Time")(sec=seconds, nanosec=nanoseconds)

    @classmethod
    def from_msg(cls, msg: Any, clock_type: ClockType = ClockType.ROS_TIME) -> Time:
        """Make a time from a builtin_interfaces/msg/Time; TypeError for anything else."""
        from sim.interfaces import message

        if not isinstance(msg, message("builtin_interfaces", "Time")):
            raise TypeError("Must pass a builtin_interfaces.msg.Time object")
        return cls(seconds=msg.sec, nanoseconds=msg.nanosec, clock_type=clock_type)
