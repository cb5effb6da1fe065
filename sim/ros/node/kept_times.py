"""Finds the times that a node keeps though its simulated clock has been set back to before them."""

from typing import Any

from sim.ros.time.clock_type import ClockType
from sim.ros.time.time import Time

LATER = 500_000_000
"""Nanoseconds that the clock goes on after a jump until a time that is still kept counts as overlooked."""


class KeptTimes:
    """The attributes of a node that held times of its clock at the last jump back."""

    def __init__(self) -> None:
        self._kept: dict[str, Time] = {}
        self._set_to = 0
        self.length = 0
        """How far the clock was set back, in nanoseconds."""

    def jumps_back(self, node: Any, old: int, new: int) -> None:
        """Remember what the node holds, before the clock goes back from one time to another."""
        self._set_to, self.length = new, old - new
        self._kept = {
            name: value
            for name, value in list(vars(node).items())  # other threads may add some meanwhile
            if isinstance(value, Time)
            and value.clock_type is ClockType.ROS_TIME
            and value.nanoseconds > new + LATER
        }

    def still_kept(self, node: Any, now: int) -> list[str]:
        """The attributes that the node has not changed since, asked once, when the clock has gone on."""
        if not self._kept or now < self._set_to + LATER:
            return []
        held, self._kept = self._kept, {}
        return [name for name, value in held.items() if vars(node).get(name) is value]
