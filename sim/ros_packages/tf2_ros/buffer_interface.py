"""``tf2_ros.buffer_interface``: transforms stamped data of all registered types."""

from collections.abc import Callable
from copy import deepcopy
from typing import Any, ClassVar

from rclpy.duration import Duration
from std_msgs.msg import Header

__all__ = [
    "BufferInterface",
    "ConvertRegistration",
    "NotImplementedException",
    "Stamped",
    "TransformRegistration",
    "TypeException",
    "convert",
]

_AT_ONCE = Duration()


class TypeException(Exception):
    """No transformation or conversion is registered for a type."""

    def __init__(self, errstr: str) -> None:
        super().__init__(errstr)
        self.errstr = errstr


class NotImplementedException(Exception):
    """A buffer does not define a method that every buffer needs."""

    def __init__(self) -> None:
        self.errstr = "CanTransform or LookupTransform not implemented"
        super().__init__(self.errstr)


class BufferInterface:
    """Base of buffers of transforms. A buffer defines the four lookups."""

    def __init__(self) -> None:
        self.registration = TransformRegistration()

    def transform(
        self, object_stamped: Any, target_frame: str, timeout: Any = _AT_ONCE, new_type: Any = None
    ) -> Any:
        """Transform data with a header from its frame to another frame, at its time.

        Raises:
            TypeException: no imported package, such as tf2_geometry_msgs, has registered the type.
            TransformException: as `lookup_transform`.
        """
        do_transform = self.registration.get(type(object_stamped))
        header = object_stamped.header
        found = self.lookup_transform(target_frame, header.frame_id, header.stamp, timeout)
        return _as(new_type, do_transform(object_stamped, found))

    def transform_full(
        self,
        object_stamped: Any,
        target_frame: str,
        target_time: Any,
        fixed_frame: str,
        timeout: Any = _AT_ONCE,
        new_type: Any = None,
    ) -> Any:
        """As `transform`, to a frame at another time."""
        do_transform = self.registration.get(type(object_stamped))
        header = object_stamped.header
        found = self.lookup_transform_full(
            target_frame, target_time, header.frame_id, header.stamp, fixed_frame, timeout
        )
        return _as(new_type, do_transform(object_stamped, found))

    def lookup_transform(self, *_asked: Any, **_more: Any) -> Any:
        """Raise NotImplementedException: a buffer defines the lookups."""
        raise NotImplementedException

    lookup_transform_full = can_transform = can_transform_full = lookup_transform


def Stamped(obj: Any, stamp: Any, frame_id: str) -> Any:
    """Set the header of an object, and return the object."""
    obj.header = Header(frame_id=frame_id, stamp=stamp)
    return obj


class TransformRegistration:
    """The transformations of types, for all buffers of the process."""

    _known: ClassVar[dict[Any, Callable[[Any, Any], Any]]] = {}

    def add(self, key: Any, callback: Callable[[Any, Any], Any]) -> None:
        """Register ``callback(data, transform)`` for a type."""
        self._known[key] = callback

    def get(self, key: Any) -> Callable[[Any, Any], Any]:
        """The function that transforms data of a type; TypeException if the type is not registered."""
        return _get(self._known, key)

    def print_me(self) -> None:
        """Print what is registered."""
        print(self._known)  # noqa: T201


class ConvertRegistration:
    """The conversions between types, for the whole process."""

    _to_msg: ClassVar[dict[Any, Callable[[Any], Any]]] = {}
    _from_msg: ClassVar[dict[Any, Callable[[Any], Any]]] = {}
    _convert: ClassVar[dict[Any, Callable[[Any], Any]]] = {}

    def add_to_msg(self, key: Any, callback: Callable[[Any], Any]) -> None:
        """Register ``callback``, which converts data of a type to a message."""
        self._to_msg[key] = callback

    def add_from_msg(self, key: Any, callback: Callable[[Any], Any]) -> None:
        """Register ``callback``, which converts a message to data of a type."""
        self._from_msg[key] = callback

    def add_convert(self, key: Any, callback: Callable[[Any], Any]) -> None:
        """Register ``callback``, which converts directly between the two types of ``key``."""
        self._convert[key] = callback

    def get_to_msg(self, key: Any) -> Callable[[Any], Any]:
        """The conversion from a type to a message; TypeException if none is registered."""
        return _get(self._to_msg, key)

    def get_from_msg(self, key: Any) -> Callable[[Any], Any]:
        """The conversion from a message to a type; TypeException if none is registered."""
        return _get(self._from_msg, key)

    def get_convert(self, key: Any) -> Callable[[Any], Any]:
        """The conversion between two types; TypeException if none is registered."""
        return _get(self._convert, key)


def _get(known: dict[Any, Callable[..., Any]], key: Any) -> Callable[..., Any]:
    if key not in known:
        raise TypeException(f"Type {key} is not loaded or supported")
    return known[key]


def _as(new_type: Any, data: Any) -> Any:
    return data if new_type is None else convert(data, new_type)


def convert(a: Any, b_type: Any) -> Any:
    """Convert data to another type: directly if that is registered, otherwise by way of a message.

    Raises:
        TypeException: no conversion is registered.
    """
    registered = ConvertRegistration()
    try:
        directly = registered.get_convert((type(a), b_type))
    except TypeException:
        if type(a) is b_type:
            return deepcopy(a)
        return registered.get_from_msg(b_type)(registered.get_to_msg(type(a))(a))
    return directly(a)
