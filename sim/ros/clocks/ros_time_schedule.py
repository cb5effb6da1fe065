"""The next due time of a timer, also while its clock follows ROS time, which is set step by step.

The rules are those of rcl's timers, in nanoseconds of the timer's clock.
"""

from dataclasses import dataclass, replace


def next_due(due: int, period: int, now: int) -> int:
    """The next due time of a timer that was due at ``due`` and is called at ``now``, in nanoseconds.

    A tick at the exact time of a late call is missed, like the ticks before it, also if the clock stands
    still.
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
    """The next and last call of a timer; ``credit`` is the time before the next call when time became 0."""

    due: int
    last_call: int
    credit: int = 0

    def called(self, now: int, period: int) -> None:
        """The timer was called at ``now``."""
        self.last_call = now
        self.due = next_due(self.due, period, now)

    def time_set(self, now: int, period: int) -> None:
        """The clock was set to ``now``; if that is before the last call, the timer restarts."""
        if now < self.due and now < self.last_call:
            self.due = now + period
            self.last_call = now


def after_change(schedule: RosTimeSchedule, now: int, period: int, credit: int) -> RosTimeSchedule:
    """The schedule after the time source has changed and shows ``now``.

    ``credit`` is the time that was left before the next call. If it is 0, the schedule stays. If ``now`` is
    0, which means an unknown time, only the credit is stored.
    """
    if now == 0:
        return replace(schedule, credit=credit)
    if credit == 0:
        return schedule
    return RosTimeSchedule(now - credit + period, now - credit)
