"""The clocks that a node reads, all of them views of the one clock that the run lives on."""

from sim.ros.clock_type import ClockType
from sim.ros.duration import Duration
from sim.ros.host import current_host
from sim.ros.time import Time

__all__ = ["Clock", "ClockType", "ROSClock"]


class Clock:
    """A clock of one kind; steady time counts from the run's beginning, the others from 1970."""

    def __init__(self, *, clock_type: ClockType = ClockType.SYSTEM_TIME) -> None:
        if not isinstance(clock_type, ClockType):
            raise TypeError("Clock type must be a ClockType enum")
        self._clock_type = clock_type
        self._host = current_host()

    @property
    def clock_type(self) -> ClockType:
        """The kind of this clock."""
        return self._clock_type

    def now(self) -> Time:
        """The time it is."""
        elapsed = self._host.clock.now()
        if self._clock_type != ClockType.STEADY_TIME:
            elapsed += self._host.clock.epoch
        return Time(nanoseconds=elapsed, clock_type=self._clock_type)

    def sleep_for(self, rel_time: Duration) -> bool:
        """Sleep for a length of time on the calling thread."""
        self._host.clock.sleep(rel_time.nanoseconds)
        return True

    def sleep_until(self, until: Time) -> bool:
        """Sleep until a time of this clock has come.

        Raises:
            ValueError: the time belongs to another kind of clock.
        """
        if until.clock_type != self._clock_type:
            raise ValueError("until's clock type does not match this clock's type")
        return self.sleep_for(until - self.now())

    def __repr__(self) -> str:
        return f"Clock(clock_type={self._clock_type.name})"


class ROSClock(Clock):
    """The clock that nodes use by default."""

    def __init__(self) -> None:
        super().__init__(clock_type=ClockType.ROS_TIME)
