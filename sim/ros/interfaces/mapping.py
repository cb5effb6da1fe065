"""Filling a message from plain values, as they come from YAML on a command line."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, TypeVar

from sim.ros.interfaces.base import Message
from sim.ros.interfaces.field_types import (
    FLOAT_LIMITS,
    INTEGER_LIMITS,
    Array,
    BasicType,
    BoundedSequence,
    ElementType,
    FieldType,
    NamespacedType,
    UnboundedSequence,
)

MessageT = TypeVar("MessageT", bound=Message)


class MappingError(ValueError):
    """A value does not fit the message; the text names its place, such as ``linear.x``."""


def message_from_mapping(cls: type[MessageT], mapping: Mapping[str, object]) -> MessageT:
    """Return a message with the fields given in ``mapping`` set and all others at their defaults.

    Messages are mappings, arrays and sequences are lists. As ``ros2 topic pub`` does, an integer
    is taken where a float is wanted, 0 or 1 for a truth value, a number for a text; a byte is an
    integer from 0 to 255.

    Raises:
        MappingError: a field does not exist, or a value does not fit.
    """
    return _filled(cls, mapping, place="")


def _filled(cls: type[MessageT], given: object, place: str) -> MessageT:
    name = cls.__type_name__
    if not isinstance(given, Mapping):
        raise MappingError(f"{_prefix(place)}{name} is written as {{field: value, …}}, not as {given!r}")
    types = cls.__interface__.types
    message = cls()
    for field, value in given.items():
        if field not in types:
            known = f"its fields are {', '.join(types)}" if types else "it has no fields"
            raise MappingError(f"{_prefix(place)}{name} has no field {field!r}; {known}")
        inner = f"{place}.{field}" if place else field
        converted = _converted(cls, types[field], value, inner)
        try:
            setattr(message, field, converted)
        except AssertionError as error:
            raise MappingError(f"{inner}: {error}") from None
    return message


def _converted(cls: type[Message], of: FieldType, given: object, place: str) -> Any:
    if not isinstance(of, Array | BoundedSequence | UnboundedSequence):
        return _converted_element(cls, of, given, place)
    if not isinstance(given, Sequence) or isinstance(given, str):
        raise MappingError(f"{place}: {of} is written as [value, …], not as {given!r}")
    return [
        _converted_element(cls, of.value_type, item, f"{place}[{index}]") for index, item in enumerate(given)
    ]


def _converted_element(cls: type[Message], of: ElementType, given: object, place: str) -> Any:
    if isinstance(of, NamespacedType):
        return _filled(cls.__interface__.parts[of], given, place)
    if not isinstance(of, BasicType):
        if isinstance(given, str | int | float):
            return str(given)
        raise MappingError(f"{place}: a text is wanted, not {given!r}")
    return _converted_basic(of.typename, given, place)


def _converted_basic(typename: str, given: object, place: str) -> bool | int | float | bytes:
    if typename == "boolean" and given in (0, 1):
        return bool(given)
    if typename in FLOAT_LIMITS and isinstance(given, int | float) and not isinstance(given, bool):
        return float(given)
    if typename in INTEGER_LIMITS and isinstance(given, int) and not isinstance(given, bool):
        return given
    if typename == "octet" and isinstance(given, int) and 0 <= given <= 255:
        return bytes([given])
    wanted = {"boolean": "true or false", "octet": "an integer from 0 to 255"}
    number = "a number" if typename in FLOAT_LIMITS else "an integer"
    raise MappingError(f"{place}: {wanted.get(typename, number)} is wanted, not {given!r}")


def _prefix(place: str) -> str:
    return f"{place}: " if place else ""
