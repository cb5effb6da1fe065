"""Messages as bytes on the wire (CDR), through rosbags' typestore."""

from __future__ import annotations

from array import array
from collections.abc import Callable, Sequence
from functools import cache
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, TypeVar, cast

import numpy as np
from attrs import frozen
from rosbags.interfaces import Nodetype

from sim.ros.interfaces.base import Interface, Message, assemble
from sim.ros.interfaces.field_types import (
    Array,
    BasicType,
    BoundedSequence,
    BoundedWString,
    FieldType,
    NamespacedType,
    UnboundedSequence,
    UnboundedWString,
)
from sim.ros.interfaces.interface_definition import FILLER_FIELD
from sim.ros.interfaces.sequences import typecode

if TYPE_CHECKING:
    from rosbags.interfaces.typing import Fielddefs, FieldDesc
    from rosbags.typesys.store import Typestore

MessageT = TypeVar("MessageT", bound=Message)

_WIDE_TEXT = "sim/msg/WideText"
"""How rosbags is told of a wide string: as a message that holds its units."""


def to_cdr(message: Message) -> bytes:
    """Return a message as little-endian CDR with its four bytes of header. Thread-safe.

    Wide strings become their number of UTF-16 units and these units in four bytes each, as in
    rosidl_typesupport_fastrtps.
    """
    store = _wire_of(type(message))
    return bytes(store.serialize_cdr(_outward(message), message.__type_name__, little_endian=True))


def from_cdr(cls: type[MessageT], data: bytes) -> MessageT:
    """Return the message of class ``cls`` that CDR bytes of either byte order hold. Thread-safe.

    Raises:
        ValueError: the bytes are no such message.
    """
    from rosbags.serde import SerdeError

    name = cls.__type_name__
    try:
        return cast("MessageT", _wire(cls).deserialize_cdr(data, name))
    except (SerdeError, UnicodeDecodeError) as error:
        raise ValueError(f"these {len(data)} bytes hold no {name}: {error}") from None


@cache
def _wire(cls: type[Message]) -> Typestore:
    """Return a typestore of a class and all that it contains.

    Every class has its own, because two classes may have one name: an interface and what replaced it.
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
    """Return the type to give rosbags, which knows no wide strings."""
    if of[0] == Nodetype.BASE:
        return (Nodetype.NAME, _WIDE_TEXT) if of[1][0] == "wstring" else of
    if of[0] == Nodetype.NAME:
        return of
    inner, size = of[1]
    return cast("FieldDesc", (of[0], (_on_wire(cast("FieldDesc", inner)), size)))


@cache
def _wire_of(kind: type[Message]) -> Typestore:
    """Return the typestore of the class made from the definition, of which a message's may be a subclass."""
    return _wire(next(cls for cls in kind.__mro__ if "__interface__" in vars(cls)))


@frozen
class _Coding:
    """How a field's value goes into rosbags' serialiser and how it comes out of it."""

    outward: Callable[[Any], Any]
    inward: Callable[[Any], Any]


@cache
def _codings(interface: Interface) -> dict[str, _Coding]:
    return {name: _coding(of) for name, of in interface.types.items()}


def _outward(message: Message) -> SimpleNamespace:
    """Return a message with the values rosbags writes: numpy arrays for all sequences of numbers."""
    codings = _codings(message.__interface__).items()
    values = {name: coding.outward(getattr(message, name)) for name, coding in codings}
    return SimpleNamespace(**(values or {FILLER_FIELD: 0}))


def _inward(cls: type[Message], values: Sequence[Any]) -> Message:
    """Return the message of the values rosbags read, which stand in the order of the fields."""
    codings = _codings(cls.__interface__).items()
    pairs = zip(codings, values, strict=False)
    return assemble(cls, {name: coding.inward(value) for (name, coding), value in pairs})


def _coding(of: FieldType) -> _Coding:
    if isinstance(of, Array | BoundedSequence | UnboundedSequence):
        return _sequence_coding(of)
    if isinstance(of, UnboundedWString | BoundedWString):
        return _Coding(_wide_outward, _wide_inward)
    if isinstance(of, NamespacedType):
        return _Coding(_outward, _unchanged)
    if of == BasicType("octet"):
        return _Coding(_signed, _octet)
    return _Coding(_unchanged, _unchanged)


def _sequence_coding(of: Array | BoundedSequence | UnboundedSequence) -> _Coding:
    code = typecode(of)
    if code is not None:
        inward = np.copy if isinstance(of, Array) else lambda values: array(code, values.tobytes())
        return _Coding(lambda values: np.ascontiguousarray(values).ravel(), inward)
    if of.value_type == BasicType("boolean"):
        return _Coding(lambda values: np.array(list(values), np.bool_), np.ndarray.tolist)
    if of.value_type == BasicType("octet"):
        return _Coding(
            lambda values: np.array(list(b"".join(values)), np.uint8),
            lambda values: [_octet(value) for value in values.tolist()],
        )
    element = _coding(of.value_type)
    return _Coding(
        lambda values: [element.outward(value) for value in values],
        lambda values: [element.inward(value) for value in values],
    )


def _wide_outward(text: str) -> SimpleNamespace:
    units = np.frombuffer(text.encode("utf-16-le", "surrogatepass"), "<u2")
    return SimpleNamespace(units=units.astype(np.uint32))


def _wide_inward(units: np.ndarray[Any, Any]) -> str:
    return units.astype("<u2").tobytes().decode("utf-16-le", "surrogatepass")


def _unchanged(value: Any) -> Any:
    return value


def _signed(octet: bytes) -> int:
    return int.from_bytes(octet, "little", signed=True)


def _octet(number: int) -> bytes:
    return bytes([number & 0xFF])
