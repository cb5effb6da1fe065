"""The history of one frame in a buffer: its poses in the parent frame over time."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass

from sim.ros_packages.tf2_py.exceptions import ExtrapolationException
from sim.ros_packages.tf2_py.motion import Motion

NEWEST = 0
"""The time that means the newest data."""


@dataclass(frozen=True, slots=True, eq=False)
class Sample:
    """One transform from a frame to its parent, at ``stamp`` nanoseconds."""

    stamp: int
    parent: str
    motion: Motion

    def same_as(self, other: Sample) -> bool:
        """Whether both have the same stamp, parent and motion."""
        return (self.stamp, self.parent) == (other.stamp, other.parent) and self.motion.same_as(other.motion)


class FixedHistory:
    """The last static transform of a frame, which is valid at all times."""

    def __init__(self) -> None:
        self.samples: Sequence[Sample] = ()

    def add(self, sample: Sample) -> bool:
        """Replace the transform; True."""
        self.samples = (Sample(NEWEST, sample.parent, sample.motion),)
        return True

    def clear(self) -> None:
        """Keep the transform: static ones remain after a jump of the clock."""

    def at(self, time: int) -> Sample:
        """The transform, which is the same at all times."""
        return self.samples[0]


class MovingHistory:
    """The transforms of a frame over the last ``length`` nanoseconds, oldest first.

    The samples are replaced, never changed: readers need no lock, writers take turns.
    """

    def __init__(self, length: int) -> None:
        self._length = length
        self.samples: Sequence[Sample] = ()

    def add(self, sample: Sample) -> bool:
        """Insert a sample by its time, and drop samples that are too old; False if this sample is too old."""
        known = self.samples
        newest = max(sample.stamp, known[-1].stamp) if known else sample.stamp
        if sample.stamp < newest - self._length:
            return False
        place = bisect_right(known, sample.stamp, key=_stamp)
        first = bisect_right(known, newest - self._length - 1, key=_stamp)
        same_time = (each for each in known[:place] if each.stamp == sample.stamp)
        if not any(map(sample.same_as, same_time)):
            self.samples = (*known[first:place], sample, *known[place:])
        return True

    def clear(self) -> None:
        """Drop all samples."""
        self.samples = ()

    def at(self, time: int) -> Sample:
        """The transform at a time, interpolated between two samples if necessary.

        Raises:
            ExtrapolationException: the time is before the oldest sample or after the newest one.
        """
        known = self.samples
        if not known:
            raise ExtrapolationException("")
        oldest, newest = known[0], known[-1]
        if time in {NEWEST, newest.stamp}:
            return newest
        if len(known) == 1:
            raise ExtrapolationException(
                f"Lookup would require extrapolation at time {shown(time)}, "
                f"but only time {shown(newest.stamp)} is in the buffer"
            )
        if time > newest.stamp:
            raise ExtrapolationException(
                f"Lookup would require extrapolation into the future.  Requested time {shown(time)} "
                f"but the latest data is at time {shown(newest.stamp)}"
            )
        if time < oldest.stamp:
            raise ExtrapolationException(
                f"Lookup would require extrapolation into the past.  Requested time {shown(time)} "
                f"but the earliest data is at time {shown(oldest.stamp)}"
            )
        place = bisect_right(known, time, key=_stamp)
        before, after = known[place - 1], known[place]
        if before.parent != after.parent:
            return before
        share = (time - before.stamp) / (after.stamp - before.stamp)
        return Sample(time, before.parent, before.motion.towards(after.motion, share))


def _stamp(sample: Sample) -> int:
    return sample.stamp


def shown(time: int) -> str:
    """A time in seconds, as tf2 prints it."""
    return f"{time / 1e9:.6f}"
