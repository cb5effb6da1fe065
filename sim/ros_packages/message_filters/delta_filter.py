"""``message_filters.delta_filter``: passes on a message if it differs from the last one that passed."""

from abc import ABC
from collections.abc import Callable, Iterable
from typing import Any

from sim.ros_packages.message_filters.simple_filter import SimpleFilter

Getter = Callable[[Any], Any]
"""Returns the value of a field of a message."""


class ComparisonHandler(ABC):  # noqa: B024 -- as in message_filters
    """Decides which messages pass."""

    def message_fits(self, message: Any) -> bool:
        """Whether a message passes."""
        raise NotImplementedError

    def do_fields_fit(self, field_a: Any, field_b: Any) -> bool:
        """Whether a field's two values let a message pass."""
        raise NotImplementedError


class CachedComparisonHandler(ComparisonHandler):
    """Compares fields with those of the last message that passed; the first one passes.

    A subclass defines ``_field_getters`` and ``do_fields_fit``; one field that fits is enough.
    """

    _field_getters: Iterable[Getter]

    def __init__(self) -> None:
        self._message_cache: Any = None

    def message_fits(self, message: Any) -> bool:
        """Whether a message passes; if so, it is the next one to compare with."""
        last = self._message_cache
        fits = last is None or any(
            self.do_fields_fit(get_field(last), get_field(message)) for get_field in self._field_getters
        )
        if fits:
            self._message_cache = message
        return fits

    def do_fields_fit(self, field_a: Any, field_b: Any) -> bool:
        """Whether two values fit: to be defined by a subclass."""
        raise NotImplementedError(
            f"Field comparison not implemented for class: {type(self).__name__}. "
            "Consider implementing do_fields_fit"
        )


class DeltaCompare(CachedComparisonHandler):
    """Fields fit if they have changed; each getter has to return a bool, int, float or str.

    Raises:
        TypeError: while comparing, if a value has another type.
    """

    def __init__(self, field_getters: Iterable[Getter]) -> None:
        super().__init__()
        self._field_getters = list(field_getters)

    def do_fields_fit(self, field_a: Any, field_b: Any) -> bool:
        """Whether the two values differ."""
        if not all(isinstance(each, bool | int | float | str) for each in (field_a, field_b)):
            raise TypeError(f"Unable to compare fields of types {type(field_a)} and {type(field_b)}")
        return bool(field_a != field_b)


class ComparisonFilter(SimpleFilter):
    """Passes on the messages that a handler accepts."""

    def __init__(self, comparison_handler: ComparisonHandler, message_filter: Any = None) -> None:
        super().__init__()
        self._comparison_handler = comparison_handler
        self.incoming_connection: int | None = None
        self.connectInput(message_filter)

    def add(self, message: Any) -> None:
        """Pass on a message if the handler accepts it."""
        if self.message_fits(message):
            self.signalMessage(message)

    def message_fits(self, message: Any) -> bool:
        """Whether a message passes."""
        return self._comparison_handler.message_fits(message)

    def connectInput(self, message_filter: Any) -> None:
        """Connect to a filter; None connects to nothing.

        Raises:
            RuntimeError: this filter is connected already.
        """
        if self.incoming_connection is not None:
            raise RuntimeError("This instance of ComparisonFilter already has an incoming connection")
        if message_filter is not None:
            self.incoming_connection = message_filter.registerCallback(self.add)


class DeltaFilter(ComparisonFilter):
    """Passes on a message if a field has changed since the last one that passed."""

    def __init__(self, field_getters: Iterable[Getter], message_filter: Any = None) -> None:
        super().__init__(DeltaCompare(field_getters), message_filter)


class PathDeltaFilter(DeltaFilter):
    """As `DeltaFilter`, for fields given by their paths, such as ``pose.position.x``."""

    def __init__(self, field_path_list: Iterable[str], message_filter: Any = None) -> None:
        super().__init__([self._getter(path) for path in field_path_list], message_filter)

    def _getter(self, path: str) -> Getter:
        return lambda message: self.get_field_by_path(message, path)

    def get_field_by_path(self, message: Any, field_path: str) -> Any:
        """The value of a field; RuntimeError if the message has no such field."""
        found = message
        for name in field_path.split("."):
            owner, found = found, getattr(found, name, None)
            if found is None:
                raise RuntimeError(
                    f"Unable to access field {name!r} of {type(owner).__name__} (full path: {field_path!r})"
                )
        return found
