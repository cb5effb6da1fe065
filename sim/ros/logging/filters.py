"""Log filters: once, skip_first and throttle, for each call site of a program.

The rules are rclpy's: filters are applied in the order throttle, skip_first, once, up to the first that
refuses a line; those before it count the line as logged. A call site must always have the same filters.
"""

import sys
from collections import OrderedDict
from collections.abc import Mapping
from types import FrameType
from typing import Any, ClassVar, NamedTuple

from sim.ros.clocks.clock import Clock


class CallSite(NamedTuple):
    """A place in a program that calls a logger."""

    function: str
    file: str
    line: int
    instruction: int


def calling_site() -> CallSite:
    """The call site of the running logger."""
    frame: FrameType | None = sys._getframe(1)
    while frame is not None and frame.f_globals.get("__package__") == __package__:
        frame = frame.f_back
    assert frame is not None
    return CallSite(frame.f_code.co_name, frame.f_code.co_filename, frame.f_lineno, frame.f_lasti)


class LoggingFilter:
    """Base of the filters. ``params`` has the options with their defaults; None: the option is required.

    ``context`` has the state of the filters of one call site, including their options.
    """

    params: ClassVar[Mapping[str, Any]] = {}

    @classmethod
    def initialize_context(cls, context: dict[str, Any], **options: Any) -> None:
        """Initialise the context of a call site with these options."""
        for name, default in cls.params.items():
            context[name] = options.get(name, default)

    @staticmethod
    def should_log(_context: dict[str, Any]) -> bool:
        """Whether the next line is logged; this counts the line."""
        return True


class Throttle(LoggingFilter):
    """Passes a line if ``throttle_duration_sec`` seconds have passed since the last one, on a clock."""

    params: ClassVar[Mapping[str, Any]] = {"throttle_duration_sec": None, "throttle_time_source_type": Clock}

    @classmethod
    def initialize_context(cls, context: dict[str, Any], **options: Any) -> None:
        """Initialise the context, by default with the system's clock.

        Raises:
            TypeError: the duration is missing.
            ValueError: the time source is not a clock.
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
    """Passes all lines except the first."""

    params: ClassVar[Mapping[str, Any]] = {"skip_first": None}

    @classmethod
    def initialize_context(cls, context: dict[str, Any], **options: Any) -> None:
        """Initialise the context: no line is skipped yet."""
        super().initialize_context(context, **options)
        context["first_has_been_skipped"] = False

    @staticmethod
    def should_log(context: dict[str, Any]) -> bool:
        """Whether there was a line before."""
        before: bool = context["first_has_been_skipped"]
        context["first_has_been_skipped"] = True
        return before


class Once(LoggingFilter):
    """Passes only the first line."""

    params: ClassVar[Mapping[str, Any]] = {"once": None}

    @classmethod
    def initialize_context(cls, context: dict[str, Any], **options: Any) -> None:
        """Initialise the context: no line is logged yet."""
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
"""The filters in the order in which they are applied."""


def get_filters_from_kwargs(**options: Any) -> list[str]:
    """The names of the filters that the options of a log call select.

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


class CallSiteFilters:
    """The filters of one call site, and its logger and severity. Raises as ``initialize_context``."""

    def __init__(self, name: str, severity: int, options: Mapping[str, Any]) -> None:
        self._name = name
        self._severity = severity
        self._filters = get_filters_from_kwargs(**options)
        self._options = dict(options)
        self._context: dict[str, Any] = {}
        for each in self._filters:
            supported_filters[each].initialize_context(self._context, **options)

    def require_same(self, name: str, severity: int, options: Mapping[str, Any]) -> None:
        """Raise ValueError if the call site now has another severity, name or filter than at first."""
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
