"""rclpy's ``Duration``."""

from __future__ import annotations

from functools import total_ordering
from typing import Any

_NANOSECONDS = 1_000_000_000
_LIMIT = 2**63


@total_ordering
class Duration:
    """A length of time in whole nanoseconds; may be negative. Immutable, ordered, hashable.

    A duration equals only durations.
    """

    __slots__ = ("_nanoseconds",)

    def __init__(self, *, seconds: int | float = 0, nanoseconds: int = 0) -> None:
        # A positive length is at least 1 ns: a loop that sleeps for the rest would never end on virtual time.
        total = (int(seconds * _NANOSECONDS) or int(seconds > 0)) + int(nanoseconds)
        if not -_LIMIT <= total < _LIMIT:
            raise OverflowError("Total nanoseconds value is too large to store in C duration.")
        self._nanoseconds = total

    @property
    def nanoseconds(self) -> int:
        """The whole length in nanoseconds."""
        return self._nanoseconds

    def __repr__(self) -> str:
        return f"Duration(nanoseconds={self._nanoseconds})"

    def __str__(self) -> str:
        if self == Infinite:
            return "Infinite"
        return f"{self._nanoseconds} nanoseconds"

    def __hash__(self) -> int:
        return hash(self._nanoseconds)

    def __eq__(self, other: object) -> bool:
        if isinstance(other, Duration):
            return self._nanoseconds == other._nanoseconds
        return NotImplemented

    def __lt__(self, other: Duration) -> bool:
        if isinstance(other, Duration):
            return self._nanoseconds < other._nanoseconds
        return NotImplemented

    def to_msg(self) -> Any:
        """Convert it to a builtin_interfaces/msg/Duration."""
        from sim.interfaces import message

        seconds, nanoseconds = divmod(self._nanoseconds, _NANOSECONDS)
        return message("builtin_interfaces", "Duration")(sec=seconds, nanosec=nanoseconds)

    @classmethod
    def from_msg(cls, msg: Any) -> Duration:
        """Make a duration from a builtin_interfaces/msg/Duration; TypeError for anything else."""
        from sim.interfaces import message

        if not isinstance(msg, message("builtin_interfaces", "Duration")):
            raise TypeError("Must pass a builtin_interfaces.msg.Duration object")
        return cls(seconds=msg.sec, nanoseconds=msg.nanosec)


Infinite = Duration(nanoseconds=_LIMIT - 1)
