"""``tf2_py.BufferCore``: the tree of frames, and the transforms between them. It never waits."""

import math
import sys
from _thread import RLock
from collections.abc import Container, Iterator
from dataclasses import dataclass
from functools import reduce
from typing import Any

from builtin_interfaces.msg import Time as TimeMessage
from geometry_msgs.msg import TransformStamped
from rclpy.time import Time

from sim.ros_packages.tf2_py.exceptions import (
    ConnectivityException,
    ExtrapolationException,
    InvalidArgumentException,
    LookupException,
    TransformException,
)
from sim.ros_packages.tf2_py.histories import NEWEST, FixedHistory, MovingHistory, Sample, shown
from sim.ros_packages.tf2_py.motion import IDENTITY, Motion

_SECOND = 1_000_000_000
_CACHE_TIME = 10 * _SECOND
_DEEPEST = 1000
"""The most frames on a path to the root; a longer path is a loop."""
_UNIT_TOLERANCE = 10e-3


@dataclass(frozen=True, slots=True)
class _Climb:
    """The samples on the path up from a frame, the frame at its end, and the data missing there."""

    samples: tuple[Sample, ...]
    top: str
    missing: str | None

    @property
    def motion(self) -> Motion:
        """The motion from the first frame of the path to its top."""
        return reduce(lambda below, sample: sample.motion.after(below), self.samples, IDENTITY)


class BufferCore:
    """Transforms between frames over the last seconds. Thread-safe."""

    def __init__(self, cache_time: Any = None) -> None:
        self._cache_time = _CACHE_TIME if cache_time is None else nanoseconds(cache_time, "duration")
        self._names: dict[str, None] = {}
        self._histories: dict[str, FixedHistory | MovingHistory] = {}
        self._authorities: dict[str, str] = {}
        self._writing = RLock()

    def clear(self) -> None:
        """Drop all transforms but the static ones; the frames' names stay."""
        with self._writing:
            for history in self._histories.values():
                history.clear()

    def set_transform(self, transform: Any, authority: str) -> None:
        """Add a transform that is valid at its stamp. An invalid one is ignored, with a line on stderr."""
        self._set(transform, authority, is_static=False)

    def set_transform_static(self, transform: Any, authority: str) -> None:
        """Add a transform that is valid at all times; otherwise as `set_transform`."""
        self._set(transform, authority, is_static=True)

    def _set(self, transform: Any, authority: str, *, is_static: bool) -> None:
        parent = transform.header.frame_id.removeprefix("/")
        child = transform.child_frame_id.removeprefix("/")
        motion = Motion.of(transform.transform.translation, transform.transform.rotation)
        faults = list(_faults(parent, child, motion, authority))
        for fault in faults:
            print(f"Error:   {fault}", file=sys.stderr)  # noqa: T201 -- as tf2 does
        if faults:
            return
        sample = Sample(nanoseconds(transform.header.stamp), parent, motion)
        with self._writing:
            wanted = FixedHistory if is_static else MovingHistory
            history = self._histories.get(child)
            if not isinstance(history, wanted):
                history = FixedHistory() if is_static else MovingHistory(self._cache_time)
            is_new = history.add(sample)
            self._names |= {child: None, parent: None}
            self._histories[child] = history
            if is_new:
                self._authorities[child] = authority
        if not is_new:
            print(  # noqa: T201
                f"Warning: TF_OLD_DATA ignoring data from the past for frame {child} at time "
                f"{shown(sample.stamp)} according to authority {authority}\n"
                "Possible reasons are listed at http://wiki.ros.org/tf/Errors%20explained",
                file=sys.stderr,
            )

    def lookup_transform_core(self, target_frame: str, source_frame: str, time: Any) -> Any:
        """The ``TransformStamped`` that converts data of ``source_frame`` to ``target_frame``.

        Time 0 means the latest common time.

        Raises:
            LookupException: a frame is unknown.
            ConnectivityException: the frames are in different trees.
            ExtrapolationException: there is no data for the time.
            InvalidArgumentException: a frame's name is empty or begins with a slash.
        """
        return _message(
            target_frame, source_frame, *self._look_up(target_frame, source_frame, nanoseconds(time))
        )

    def lookup_transform_full_core(
        self, target_frame: str, target_time: Any, source_frame: str, source_time: Any, fixed_frame: str
    ) -> Any:
        """As `lookup_transform_core`, from one time to another by way of a frame that is fixed meanwhile."""
        for role, frame in (("target", target_frame), ("source", source_frame), ("fixed", fixed_frame)):
            self._check(role, frame)
        first, _ = self._look_up(fixed_frame, source_frame, nanoseconds(source_time))
        second, stamp = self._look_up(target_frame, fixed_frame, nanoseconds(target_time))
        return _message(target_frame, source_frame, second.after(first), stamp)

    def can_transform_core(self, target_frame: str, source_frame: str, time: Any) -> tuple[int, str]:
        """Whether `lookup_transform_core` would succeed, and the reason if not."""
        return self._can(nanoseconds(time), target_frame, source_frame)

    def can_transform_full_core(
        self, target_frame: str, target_time: Any, source_frame: str, source_time: Any, fixed_frame: str
    ) -> tuple[int, str]:
        """Whether `lookup_transform_full_core` would succeed, and the reason if not."""
        first = self._can(nanoseconds(target_time), target_frame, fixed_frame)
        return self._can(nanoseconds(source_time), fixed_frame, source_frame) if first[0] else first

    def get_latest_common_time(self, target_frame: str, source_frame: str) -> Any:
        """The newest ``rclpy.time.Time`` for which the transform between two frames is known."""
        for frame in (target_frame, source_frame):
            _require(frame, "get_latest_common_time", self._names)
        return Time(nanoseconds=self._latest_common_time(target_frame, source_frame))

    def all_frames_as_string(self) -> str:
        """One sentence for each frame with a parent."""
        return "".join(
            f"Frame {child} exists with parent {_parent(history)}.\n" for child, history in self._in_order()
        )

    def all_frames_as_yaml(self) -> str:
        """The frames with a parent, their rates and times, as a YAML document."""
        if not self._names:
            return "[]"
        return "".join(
            f"{child}: \n"
            f"  parent: '{history.samples[-1].parent}'\n"
            f"  broadcaster: '{self._authorities[child]}'\n"
            f"  rate: {_rate(history):.3f}\n"
            f"  most_recent_transform: {shown(history.samples[-1].stamp)}\n"
            f"  oldest_transform: {shown(history.samples[0].stamp)}\n"
            f"  buffer_length: {(history.samples[-1].stamp - history.samples[0].stamp) / 1e9:.3f}\n"
            for child, history in self._in_order()
            if history.samples
        )

    def _frameExists(self, frame: str) -> bool:
        return frame in self._names

    def _getFrameStrings(self) -> list[str]:
        return list(self._names)

    def _in_order(self) -> Iterator[tuple[str, FixedHistory | MovingHistory]]:
        known = dict(self._histories)
        return ((name, known[name]) for name in tuple(self._names) if name in known)

    def _can(self, time: int, target: str, source: str) -> tuple[int, str]:
        if target == source:
            return 1, ""
        for role, frame in (("target", target), ("source", source)):
            fault = _fault_of(frame, self._names)
            if fault is not None:
                return 0, f'Invalid frame ID "{frame}" passed to canTransform argument {role}_frame - {fault}'
        try:
            self._way(target, source, time)
        except TransformException as error:
            return 0, str(error)
        return 1, ""

    def _check(self, role: str, frame: str) -> None:
        _require(frame, f"lookupTransform argument {role}_frame", self._names)

    def _look_up(self, target: str, source: str, time: int) -> tuple[Motion, int]:
        """The motion from one frame to another, and its time."""
        if target == source:
            history = self._histories.get(target)
            newest = history.samples[-1].stamp if history and history.samples else NEWEST
            return IDENTITY, time or newest
        self._check("target", target)
        self._check("source", source)
        return self._way(target, source, time)

    def _way(self, target: str, source: str, time: int) -> tuple[Motion, int]:
        if time == NEWEST:
            time = self._latest_common_time(target, source)
        up = self._climb(source, (target,), time)
        if up.top == target:
            return up.motion, time
        down = self._climb(target, (up.top, source), time)
        asked = f", when looking up transform from frame [{source}] to frame [{target}]"
        if down.missing is not None:
            raise ExtrapolationException(down.missing + asked)
        if down.top == source:
            return down.motion.inverse(), time
        if down.top == up.top:
            return down.motion.inverse().after(up.motion), time
        if up.missing is not None:
            raise ExtrapolationException(up.missing + asked)
        raise _unconnected(target, source)

    def _latest_common_time(self, target: str, source: str) -> int:
        up = self._climb(source, (target,), NEWEST)
        passed = (source, *(sample.parent for sample in up.samples))
        down = self._climb(target, passed, NEWEST)
        if down.top not in passed:
            raise _unconnected(target, source)
        used = (*up.samples[: passed.index(down.top)], *down.samples)
        return min((sample.stamp for sample in used if sample.stamp != NEWEST), default=NEWEST)

    def _climb(self, frame: str, ends: Container[str], time: int) -> _Climb:
        """Go up from a frame to the first of ``ends``, to a frame without parent, or to missing data."""
        samples: list[Sample] = []
        while frame not in ends and (history := self._histories.get(frame)) is not None:
            try:
                sample = history.at(time)
            except ExtrapolationException as error:
                return _Climb(tuple(samples), frame, str(error))
            samples.append(sample)
            frame = sample.parent
            if len(samples) > _DEEPEST:
                raise LookupException(
                    f"The tf tree is invalid because it contains a loop.\n{self.all_frames_as_string()}\n"
                )
        return _Climb(tuple(samples), frame, None)


def nanoseconds(time: Any, what: str = "time") -> int:
    """The nanoseconds of a time or duration, which is a message or an object of rclpy.

    Raises:
        TypeError: it is neither of them.
    """
    if hasattr(time, "sec") and hasattr(time, "nanosec"):
        return int(time.sec * _SECOND + time.nanosec)
    if hasattr(time, "nanoseconds"):
        return int(time.nanoseconds)
    raise TypeError(f"{what} must have sec and nanosec, or nanoseconds.")


def _fault_of(frame: str, known: Container[str]) -> str | None:
    if not isinstance(frame, str):
        raise TypeError(f"a frame's name must be str, not {type(frame).__name__}")
    if not frame:
        return "in tf2 frame_ids cannot be empty"
    if frame.startswith("/"):
        return "in tf2 frame_ids cannot start with a '/'"
    return None if frame in known else "frame does not exist"


def _require(frame: str, where: str, known: Container[str]) -> None:
    fault = _fault_of(frame, known)
    if fault is None:
        return
    if frame and not frame.startswith("/"):
        raise LookupException(f'"{frame}" passed to {where} does not exist. ')
    raise InvalidArgumentException(f'Invalid argument "{frame}" passed to {where} - {fault}')


def _unconnected(target: str, source: str) -> ConnectivityException:
    return ConnectivityException(
        f"Could not find a connection between '{target}' and '{source}' because they are not part of the "
        "same tree.Tf has two or more unconnected trees."
    )


def _faults(parent: str, child: str, motion: Motion, authority: str) -> Iterator[str]:
    """The faults of a transform, in tf2's words."""
    if child == parent:
        yield (
            f'TF_SELF_TRANSFORM: Ignoring transform from authority "{authority}" with frame_id and  '
            f'child_frame_id "{child}" because they are the same'
        )
    if not child:
        yield (
            f'TF_NO_CHILD_FRAME_ID: Ignoring transform from authority "{authority}" because child_frame_id '
            "not set "
        )
    if not parent:
        yield (
            f'TF_NO_FRAME_ID: Ignoring transform with child_frame_id "{child}"  from authority "{authority}" '
            "because frame_id not set"
        )
    w, *xyz = (f"{each:f}" for each in motion.rotation)
    rotation = " ".join((*xyz, w))
    if any(map(math.isnan, (*motion.translation, *motion.rotation))):
        translation = " ".join(f"{each:f}" for each in motion.translation)
        yield (
            f'TF_NAN_INPUT: Ignoring transform for child_frame_id "{child}" from authority "{authority}" '
            f"because of a nan value in the transform ({translation}) ({rotation})"
        )
    if not abs(motion.rotation @ motion.rotation - 1.0) < _UNIT_TOLERANCE:
        yield (
            f'TF_DENORMALIZED_QUATERNION: Ignoring transform for child_frame_id "{child}" from authority '
            f'"{authority}" because of an invalid quaternion in the transform ({rotation})'
        )


def _parent(history: FixedHistory | MovingHistory) -> str:
    return history.samples[-1].parent if history.samples else "NO_PARENT"


def _rate(history: FixedHistory | MovingHistory) -> float:
    samples = history.samples
    return len(samples) * 1e9 / max(samples[-1].stamp - samples[0].stamp, 100_000)


def _message(target: str, source: str, motion: Motion, stamp: int) -> Any:
    made = TransformStamped(child_frame_id=source)
    made.header.frame_id = target
    made.header.stamp = TimeMessage(sec=stamp // _SECOND, nanosec=stamp % _SECOND)
    motion.write(made.transform.translation, made.transform.rotation)
    return made
