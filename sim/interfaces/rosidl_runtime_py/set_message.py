"""Fills a message from a dictionary; mirrors ``rosidl_runtime_py.set_message``."""

from array import array
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np

from sim.interfaces.base import Message
from sim.interfaces.rosidl_runtime_py.convert import field_types, is_nested
from sim.interfaces.rosidl_runtime_py.utilities import import_message_from_namespaced_type

SetStamp = Callable[[Message], None]
"""Sets a field to a time, a ``builtin_interfaces/msg/Time``."""


def set_message_fields(
    msg: Message, values: Mapping[str, Any], expand_header_auto: bool = False, expand_time_now: bool = False
) -> list[SetStamp]:
    """Set fields of a message to ``values``; nested messages are dictionaries.

    Numbers and texts are converted to the class of their field. With ``expand_header_auto`` a
    header may be ``"auto"``, and with ``expand_time_now`` a time may be ``"now"``: a function is returned for
    each of them, to be called with the time as a message.

    Raises:
        TypeError: ``values``, or the value of a nested message, is not a dictionary.
        AttributeError: a field does not exist.
        ValueError: a number cannot be read.
        AssertionError: a value does not fit its field.
    """
    return _Filling(expand_header_auto, expand_time_now).fill(msg, values)


class _Filling:
    """One call, with the words that mean the time."""

    def __init__(self, header_auto: bool, time_now: bool) -> None:
        self._words = {
            "std_msgs/msg/Header": "auto" if header_auto else None,
            "builtin_interfaces/msg/Time": "now" if time_now else None,
        }
        self._stamps: list[SetStamp] = []

    def fill(self, msg: Message, values: Mapping[str, Any]) -> list[SetStamp]:
        self._fill(msg, values)
        return self._stamps

    def _fill(self, msg: Message, values: Any) -> None:
        if not isinstance(values, Mapping):
            raise TypeError(
                f"Value '{values}' is expected to be a dictionary but is a {type(values).__name__}"
            )
        for name, value in values.items():
            current = getattr(msg, name)
            if self._stands_for_time(current, value):
                owner, field = (msg, name) if value == "now" else (current, "stamp")
                self._stamps.append(partial(setattr, owner, field))
            else:
                setattr(msg, name, self._converted(msg, name, current, value))

    def _stands_for_time(self, current: Any, value: Any) -> bool:
        return (
            hasattr(current, "SLOT_TYPES")
            and isinstance(value, str)
            and self._words.get(_type_name(current)) == value
        )

    def _converted(self, msg: Message, name: str, current: Any, value: Any) -> Any:
        of = field_types(msg)[name]
        if is_nested(of):
            inner: Any = of.value_type
            if hasattr(inner, "namespaces"):
                is_own = isinstance(msg, Message)
                cls = msg.__interface__.parts[inner] if is_own else import_message_from_namespaced_type(inner)
                return [self._message(cls, item) for item in value]
            return _sequence(current, value)
        if hasattr(current, "SLOT_TYPES"):
            return self._message(type(current), value)
        if isinstance(current, bytes) and isinstance(value, int):
            return bytes([value])
        return type(current)(value)

    def _message(self, cls: type[Message], value: Any) -> Message:
        if isinstance(value, cls):
            return value
        message = cls()
        self._fill(message, value)
        return message


def _type_name(message: Any) -> str:
    return f"{type(message).__module__.partition('.')[0]}/msg/{type(message).__name__}"


def _sequence(current: Any, value: Any) -> Any:
    """Return values in the kind of collection that the field holds now."""
    if isinstance(current, array):
        return array(current.typecode, value)
    return np.array(value, current.dtype) if isinstance(current, np.ndarray) else list(value)
