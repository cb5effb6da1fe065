"""``tf2_ros.buffer_interface``: transforming stamped data of any type that somebody has registered."""

from __future__ import annotations

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
    """Nobody has registered how to transform or convert a type."""

    def __init__(self, errstr: str) -> None:
        super().__init__(errstr)
        self.errstr = errstr


class NotImplementedException(Exception):
    """A buffer lacks a method that every buffer has."""

    def __init__(self) -> None:
        self.errstr = "CanTransform or LookupTransform not implemented"
        super().__init__(self.errstr)


class BufferInterface:
    """What every buffer of transforms can do. A buffer defines the four lookups."""

    def __init__(self) -> None:
        self.registration = TransformRegistration()

    def transform(
        self, object_stamped: Any, target_frame: str, timeout: Any = _AT_ONCE, new_type: Any = None
    ) -> Any:
        """Transform data with a header from its frame, at its time, into another frame.

        Raises:
            TypeException: no package that knows the type, such as tf2_geometry_msgs, was imported.
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
        """As `transform`, into a frame at another time."""
        do_transform = self.registration.get(type(object_stamped))
        header = object_stamped.header
        found = self.lookup_transform_full(
            target_frame, target_time, header.frame_id, header.stamp, fixed_frame, timeout
        )
        return _as(new_type, do_transform(object_stamped, found))

    def lookup_transform(self, *_asked: Any, **_more: Any) -> Any:
        """What a buffer has and this has not."""
        raise NotImplementedException

    lookup_transform_full = can_transform = can_transform_full = lookup_transform


def Stamped(obj: Any, stamp: Any, frame_id: str) -> Any:
    """Give an object a header."""
    obj.header = Header(frame_id=frame_id, stamp=stamp)
    return obj


class TransformRegistration:
    """How data of a type is transformed, for all buffers of the process."""

    _known: ClassVar[dict[Any, Callable[[Any, Any], Any]]] = {}

    def add(self, key: Any, callback: Callable[[Any, Any], Any]) -> None:
        """Have data of a type transformed by ``callback(data, transform)``."""
        self._known[key] = callback

    def get(self, key: Any) -> Callable[[Any, Any], Any]:
        """What transforms data of a type.

        Raises:
            TypeException: nothing does.
        """
        return _get(self._known, key)

    def print_me(self) -> None:
        """Print what is registered."""
        print(self._known)  # noqa: T201


class ConvertRegistration:
    """How data of a type becomes data of another, for all of the process."""

    _to_msg: ClassVar[dict[Any, Callable[[Any], Any]]] = {}
    _from_msg: ClassVar[dict[Any, Callable[[Any], Any]]] = {}
    _convert: ClassVar[dict[Any, Callable[[Any], Any]]] = {}

    def add_to_msg(self, key: Any, callback: Callable[[Any], Any]) -> None:
        """Have data of a type made a message by ``callback``."""
        self._to_msg[key] = callback

    def add_from_msg(self, key: Any, callback: Callable[[Any], Any]) -> None:
        """Have data of a type made of a message by ``callback``."""
        self._from_msg[key] = callback

    def add_convert(self, key: Any, callback: Callable[[Any], Any]) -> None:
        """Have data converted by ``callback`` between the two types of ``key``, with no message between."""
        self._convert[key] = callback

    def get_to_msg(self, key: Any) -> Callable[[Any], Any]:
        """What makes data of a type a message; TypeException if nothing does."""
        return _get(self._to_msg, key)

    def get_from_msg(self, key: Any) -> Callable[[Any], Any]:
        """What makes a message data of a type; TypeException if nothing does."""
        return _get(self._from_msg, key)

    def get_convert(self, key: Any) -> Callable[[Any], Any]:
        """What converts between two types; TypeException if nothing does."""
        return _get(self._convert, key)


def _get(known: dict[Any, Callable[..., Any]], key: Any) -> Callable[..., Any]:
    if key not in known:
        raise TypeException(f"Type {key} is not loaded or supported")
    return known[key]


def _as(new_type: Any, data: Any) -> Any:
    return data if new_type is None else convert(data, new_type)


def convert(a: Any, b_type: Any) -> Any:
    """Data as another type: directly if somebody registered that, by way of a message otherwise.

    Raises:
        TypeException: nobody registered a way.
    """
    registered = ConvertRegistration()
    try:
        directly = registered.get_convert((type(a), b_type))
    except TypeException:
        if type(a) is b_type:
            return deepcopy(a)
        return registered.get_from_msg(b_type)(registered.get_to_msg(type(a))(a))
    return directly(a)
