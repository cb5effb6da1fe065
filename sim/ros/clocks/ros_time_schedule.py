"""When a timer falls due next, and when while its clock follows ROS time, which somebody sets step by step.

The rules are those of rcl's timers, in nanoseconds of the timer's clock.
"""

from __future__ import annotations

from dataclasses import dataclass, replace


def next_due(due: int, period: int, now: int) -> int:
    """When a timer called at ``now``, due at ``due``, is due next. All in nanoseconds.

    A tick at the very moment of a late call is missed like those before it, also where a clock stands still.
    """
    following = due + period
    if following > now:
        return following
    if period == 0:
        return now
    missed = (now - following) // period + 1
    return following + missed * period


@dataclass(slots=True)
class RosTimeSchedule:
    """The next and the last call of a timer; ``credit`` was left before the next one when time was lost."""

    due: int
    last_call: int
    credit: int = 0

    def called(self, now: int, period: int) -> None:
        """The timer was called at ``now``."""
        self.last_call = now
        self.due = next_due(self.due, period, now)

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
