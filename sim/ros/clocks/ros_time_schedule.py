"""When a timer falls due while its clock follows ROS time, which somebody sets step by step.

The rules are those of rcl's timers, in nanoseconds of that clock.
"""

from __future__ import annotations

from dataclasses import dataclass, replace


@dataclass(slots=True)
class RosTimeSchedule:
    """The next and the last call of a timer; ``credit`` was left before the next one when time was lost."""

    due: int
    last_call: int
    credit: int = 0

    def called(self, now: int, period: int) -> None:
        """The timer was called at ``now``.

        Unlike on a clock that runs, a tick at this very moment is not missed, for the clock stands still.
        """
        self.last_call = now
        self.due += period
        if self.due < now:
            self.due = now if period == 0 else self.due + -(-(now - self.due) // period) * period

    def time_set(self, now: int, period: int) -> None:
        """The clock was set to ``now``; back by more than the last call, the timer begins anew."""
        if now < self.due and now < self.last_call:
            self.due = now + period
            self.last_call = now


def after_change(schedule: RosTimeSchedule, now: int, period: int, credit: int) -> RosTimeSchedule:
    """The schedule once the source of time changed and shows ``now``.

    ``credit`` is what was left before the next call. Without it nothing is changed, nor while the new time
    is 0, which stands for a time not known yet; then the credit is kept.
    """
    if now == 0:
        return replace(schedule, credit=credit)
    if credit == 0:
        return schedule
    return RosTimeSchedule(now - credit + period, now - credit)
