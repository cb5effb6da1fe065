"""Converts messages to CDR by the encoders of ``cdr_writing``, and back by rosbags' typestore."""

from __future__ import annotations

from array import array
from collections.abc import Callable, Sequence
from functools import cache
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar, cast

import numpy as np
from rosbags.interfaces import Nodetype
from rosbags.interfaces.typing import Fielddefs, FieldDesc

from sim.interfaces.base import Interface, Message, assemble
from sim.interfaces.cdr_writing import Encode, encoder_of
from sim.interfaces.field_types import AbstractWString, Array, BasicType, FieldType, SequenceType
from sim.interfaces.interface_definition import FILLER_FIELD
from sim.interfaces.sequences import typecode

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore

MessageT = TypeVar("MessageT", bound=Message)
_Convert: TypeAlias = Callable[[Any], Any]

_WIDE_TEXT = "sim/msg/WideText"
"""The name under which rosbags gets a wide string: a message that holds its UTF-16 units."""


def to_cdr(message: Message) -> bytes:
    """Return a message as little-endian CDR with its four bytes of header. Thread-safe.

    A wide string is written as its number of UTF-16 units and the units in four bytes each, as in
    rosidl_typesupport_fastrtps.
    """
    return _encoder(type(message))(message)


def from_cdr(cls: type[MessageT], data: bytes) -> MessageT:
    """Return the message of class ``cls`` in CDR bytes of either byte order. Thread-safe.

    Raises:
        ValueError: the bytes do not encode such a message.
    """
    from rosbags.serde import SerdeError

    name = cls.__type_name__
    try:
        return cast("MessageT", typestore_of(cls).deserialize_cdr(data, name))
    except (SerdeError, UnicodeDecodeError) as error:
        raise ValueError(f"these {len(data)} bytes hold no {name}: {error}") from None


@cache
def typestore_of(cls: type[Message]) -> Typestore:
    """Return rosbags' typestore of a class and the classes that it contains.

    A wide string is a message ``sim/msg/WideText`` there, with a sequence of units. Every class
    has a typestore of its own, because two classes may have one name: an interface and its replacement.
    """
    from rosbags.typesys.store import Typestore

    store = Typestore()
    store.types[_WIDE_TEXT] = cast("Any", lambda units: units)
    store.fielddefs[_WIDE_TEXT] = ([], [("units", (Nodetype.SEQUENCE, ((Nodetype.BASE, ("uint32", 0)), 0)))])
    _register(store, cls)
    return store


def _register(store: Typestore, cls: type[Message]) -> None:
    interface = cls.__interface__
    if cls.__type_name__ in store.fielddefs:
        return
    store.types[cls.__type_name__] = cast("Any", lambda *values: _inward(cls, values))
    own: Fielddefs = [(name, _on_wire(of)) for name, of in interface.definition.fields]
    filler: Fielddefs = [(FILLER_FIELD, (Nodetype.BASE, ("uint8", 0)))]
    store.fielddefs[cls.__type_name__] = (interface.definition.constants, own or filler)
    for part in interface.parts.values():
        _register(store, part)


def _on_wire(of: FieldDesc) -> FieldDesc:
    """Return a field's type for rosbags, which has no wide strings."""
    if of[0] == Nodetype.BASE:
        return (Nodetype.NAME, _WIDE_TEXT) if of[1][0] == "wstring" else of
    if of[0] == Nodetype.NAME:
        return of
    inner, size = of[1]
    return cast("FieldDesc", (of[0], (_on_wire(cast("FieldDesc", inner)), size)))


@cache
def _encoder(kind: type[Message]) -> Encode:
    """Return the encoder of the built class, of which ``kind`` may be a subclass."""
    return encoder_of(next(cls for cls in kind.__mro__ if "__interface__" in vars(cls)))


def _inward(cls: type[Message], values: Sequence[Any]) -> Message:
    """Return the message of the values that rosbags read, in the order of the fields."""
    conversions = _conversions(cls.__interface__).items()
    pairs = zip(conversions, values, strict=False)
    return assemble(cls, {name: convert(value) for (name, convert), value in pairs})


@cache
def _conversions(interface: Interface) -> dict[str, _Convert]:
    return {name: _conversion(of) for name, of in interface.types.items()}


def _conversion(of: FieldType) -> _Convert:
    """Return the function that converts a value from rosbags to a field's value."""
    if isinstance(of, SequenceType):
        return _sequence_conversion(of)
    if isinstance(of, AbstractWString):
        return _wide_text
    return _octet if of == BasicType("octet") else _unchanged


def _sequence_conversion(of: SequenceType) -> _Convert:
    code = typecode(of)
    if code is not None:
        return np.copy if isinstance(of, Array) else lambda values: array(code, values.tobytes())
    if of.value_type == BasicType("boolean"):
        return np.ndarray.tolist
    if of.value_type == BasicType("octet"):
        return lambda values: [_octet(value) for value in values.tolist()]
    convert = _conversion(of.value_type)
    return lambda values: [convert(value) for value in values]


def _wide_text(units: np.ndarray[Any, Any]) -> str:
    return units.astype("<u2").tobytes().decode("utf-16-le", "surrogatepass")


def _unchanged(value: Any) -> Any:
    return value


def _octet(number: int) -> bytes:
    return bytes([number & 0xFF])
