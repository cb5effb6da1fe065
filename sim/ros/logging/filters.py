"""What holds back lines of a log: once, skip_first and throttle, for each place in a program that logs.

The rules are rclpy's: filters are asked in the order throttle, skip_first, once; the first that refuses ends
the asking, and those before it count the line as logged. What a place asked for first, it must ask for ever.
"""

from __future__ import annotations

import sys
from collections import OrderedDict
from collections.abc import Mapping
from types import FrameType
from typing import Any, ClassVar, NamedTuple

from sim.ros.clocks.clock import Clock


class CallSite(NamedTuple):
    """A place in a program."""

    function: str
    file: str
    line: int
    instruction: int


def calling_place() -> CallSite:
    """The place that called a logger."""
    frame: FrameType | None = sys._getframe(1)
    while frame is not None and frame.f_globals.get("__package__") == __package__:
        frame = frame.f_back
    assert frame is not None
    return CallSite(frame.f_code.co_name, frame.f_code.co_filename, frame.f_lineno, frame.f_lasti)


class LoggingFilter:
    """Base of the filters. ``params`` are its options with their defaults; None: it needs the option.

    What a place has of a filter is kept in ``context``, the filter's options among it.
    """

    params: ClassVar[Mapping[str, Any]] = {}

    @classmethod
    def initialize_context(cls, context: dict[str, Any], **options: Any) -> None:
        """Begin at a place that logs with these options."""
        for name, default in cls.params.items():
            context[name] = options.get(name, default)

    @staticmethod
    def should_log(_context: dict[str, Any]) -> bool:
        """Whether the next line is logged; counts it."""
        return True


class Throttle(LoggingFilter):
    """Lets a line pass ``throttle_duration_sec`` seconds after the one before it, on some clock."""

    params: ClassVar[Mapping[str, Any]] = {"throttle_duration_sec": None, "throttle_time_source_type": Clock}

    @classmethod
    def initialize_context(cls, context: dict[str, Any], **options: Any) -> None:
        """Begin; without a clock among the options, with the system's.

        Raises:
            TypeError: the duration is missing.
            ValueError: the time source is no clock.
        """
        _require_options(cls, "throttle", options)
        super().initialize_context(context, **options)
        clock = context["throttle_time_source_type"]
        if clock is Clock:
            context["throttle_time_source_type"] = Clock()
        elif not isinstance(clock, Clock):
            raise ValueError(f'Received throttle_time_source_type of "{clock}" is not a clock instance')
        context["throttle_last_logged"] = 0

    @staticmethod
    def should_log(context: dict[str, Any]) -> bool:
        """Whether enough time has passed."""
        now = context["throttle_time_source_type"].now().nanoseconds
        if now < context["throttle_last_logged"] + context["throttle_duration_sec"] * 1e9:
            return False
        context["throttle_last_logged"] = now
        return True


class SkipFirst(LoggingFilter):
    """Lets all lines pass but the first."""

    params: ClassVar[Mapping[str, Any]] = {"skip_first": None}

    @classmethod
    def initialize_context(cls, context: dict[str, Any], **options: Any) -> None:
        """Begin with nothing skipped."""
        super().initialize_context(context, **options)
        context["first_has_been_skipped"] = False

    @staticmethod
    def should_log(context: dict[str, Any]) -> bool:
        """Whether there was a line before."""
        before: bool = context["first_has_been_skipped"]
        context["first_has_been_skipped"] = True
        return before


class Once(LoggingFilter):
    """Lets one line pass."""

    params: ClassVar[Mapping[str, Any]] = {"once": None}

    @classmethod
    def initialize_context(cls, context: dict[str, Any], **options: Any) -> None:
        """Begin with nothing logged."""
        super().initialize_context(context, **options)
        context["has_been_logged_once"] = False

    @staticmethod
    def should_log(context: dict[str, Any]) -> bool:
        """Whether this is the first line."""
        before: bool = context["has_been_logged_once"]
        context["has_been_logged_once"] = True
        return not before


supported_filters: OrderedDict[str, type[LoggingFilter]] = OrderedDict(
    throttle=Throttle, skip_first=SkipFirst, once=Once
)
"""The filters in the order in which they are asked."""


def get_filters_from_kwargs(**options: Any) -> list[str]:
    """The names of the filters that options of a log call ask for.

    Raises:
        TypeError: an unknown option, or one that a filter needs is missing.
    """
    found = []
    for name, each in supported_filters.items():
        if any(options.get(option) for option in each.params):
            _require_options(each, name, options)
            found.append(name)
    known = [option for each in supported_filters.values() for option in each.params]
    for option in options:
        if option not in known:
            raise TypeError(f'parameter "{option}" is not one of the recognized logging options "{known}"')
    return found


def _require_options(kind: type[LoggingFilter], name: str, options: Mapping[str, Any]) -> None:
    for option, default in kind.params.items():
        if default is None and option not in options:
            raise TypeError(
                f'required parameter "{option}" not specified but is required '
                f'for the the logging filter "{name}"'
            )


class LogPlace:
    """What one place logs, through which filters; raises as these do when they begin."""

    def __init__(self, name: str, severity: int, options: Mapping[str, Any]) -> None:
        self._name = name
        self._severity = severity
        self._filters = get_filters_from_kwargs(**options)
        self._options = dict(options)
        self._context: dict[str, Any] = {}
        for each in self._filters:
            supported_filters[each].initialize_context(self._context, **options)

    def require_same(self, name: str, severity: int, options: Mapping[str, Any]) -> None:
        """Raise ValueError if the place now asks for something else than at first."""
        if severity != self._severity:
            raise ValueError("Logger severity cannot be changed between calls.")
        if name != self._name:
            raise ValueError("Logger name cannot be changed between calls.")
        if (options or self._options) and get_filters_from_kwargs(**options) != self._filters:
            raise ValueError("Requested logging filters cannot be changed between calls.")
        if self._filters and options != self._options:
            raise ValueError("Logging filter parameters cannot be changed between calls.")

    def lets_pass(self) -> bool:
        """Whether the next line is logged."""
        return all(supported_filters[each].should_log(self._context) for each in self._filters)
