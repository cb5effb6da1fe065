"""What holds back lines of a log: once, skip_first and throttle, for each place in a program that logs.

The rules are rclpy's: filters are asked in the order throttle, skip_first, once; the first that refuses ends
the asking, and those before it count the line as logged. What a place asked for first, it must ask for ever.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping
from types import FrameType
from typing import Any, NamedTuple

from sim.ros.clock import Clock

_FILTERS: dict[str, dict[str, bool]] = {
    "throttle": {"throttle_duration_sec": True, "throttle_time_source_type": False},
    "skip_first": {"skip_first": True},
    "once": {"once": True},
}
"""The filters in their order, each with its parameters and whether it needs them."""

_OURS = {os.path.normcase(__file__), os.path.normcase(__file__).replace("log_filters", "logging")}


class Place(NamedTuple):
    """A place in a program."""

    function: str
    file: str
    line: int
    instruction: int


def calling_place() -> Place:
    """The place that called a logger."""
    frame: FrameType | None = sys._getframe(1)
    while frame is not None and os.path.normcase(frame.f_code.co_filename) in _OURS:
        frame = frame.f_back
    assert frame is not None
    return Place(frame.f_code.co_name, frame.f_code.co_filename, frame.f_lineno, frame.f_lasti)


class LogPlace:
    """What one place logs, through which filters.

    Raises:
        TypeError: an unknown parameter, or one that a filter needs is missing.
        ValueError: the throttle's time source is no clock.
    """

    def __init__(self, name: str, severity: int, parameters: Mapping[str, Any]) -> None:
        self._name = name
        self._severity = severity
        self._filters = _filters_in(parameters)
        self._parameters = dict(parameters)
        self._clock = parameters.get("throttle_time_source_type")
        if "throttle" in self._filters:
            self._clock = Clock() if self._clock is None else self._clock
            if not isinstance(self._clock, Clock):
                raise ValueError(
                    f'Received throttle_time_source_type of "{self._clock}" is not a clock instance'
                )
        self._last = 0
        self._skipped = False
        self._spoken = False

    def require_same(self, name: str, severity: int, parameters: Mapping[str, Any]) -> None:
        """Raise ValueError if the place now asks for something else than at first."""
        if severity != self._severity:
            raise ValueError("Logger severity cannot be changed between calls.")
        if name != self._name:
            raise ValueError("Logger name cannot be changed between calls.")
        if (parameters or self._parameters) and _filters_in(parameters) != self._filters:
            raise ValueError("Requested logging filters cannot be changed between calls.")
        if self._filters and parameters != self._parameters:
            raise ValueError("Logging filter parameters cannot be changed between calls.")

    def lets_pass(self) -> bool:
        """Whether the next line is logged."""
        return all(getattr(self, f"_{name}_passes")() for name in self._filters)

    def _throttle_passes(self) -> bool:
        assert self._clock is not None
        now = self._clock.now().nanoseconds
        if now < self._last + self._parameters["throttle_duration_sec"] * 1e9:
            return False
        self._last = now
        return True

    def _skip_first_passes(self) -> bool:
        before, self._skipped = self._skipped, True
        return before

    def _once_passes(self) -> bool:
        before, self._spoken = self._spoken, True
        return not before


def _filters_in(parameters: Mapping[str, Any]) -> list[str]:
    found = []
    for name, needs in _FILTERS.items():
        if any(parameters.get(each) for each in needs):
            for each, needed in needs.items():
                if needed and each not in parameters:
                    raise TypeError(
                        f'required parameter "{each}" not specified but is required '
                        f'for the the logging filter "{name}"'
                    )
            found.append(name)
    known = [each for needs in _FILTERS.values() for each in needs]
    for each in parameters:
        if each not in known:
            raise TypeError(f'parameter "{each}" is not one of the recognized logging options "{known}"')
    return found
