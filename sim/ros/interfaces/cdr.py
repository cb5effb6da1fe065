"""Messages as bytes on the wire (CDR) and definitions as text, both through rosbags' typestore."""

from __future__ import annotations

from array import array
from collections.abc import Callable, Sequence
from functools import cache
from threading import RLock
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
from sim.ros.interfaces.jazzy import FILLER_FIELD
from sim.ros.interfaces.sequences import typecode

if TYPE_CHECKING:
    from rosbags.interfaces.typing import Fielddefs
    from rosbags.typesys.store import Typestore

MessageT = TypeVar("MessageT", bound=Message)

_lock = RLock()


def to_cdr(message: Message) -> bytes:
    """Return a message as little-endian CDR with its four bytes of header. Thread-safe.

    Raises:
        NotImplementedError: the message contains wide strings, which rosbags does not encode.
    """
    name = message.__type_name__
    return bytes(_store_with(type(message)).serialize_cdr(_outward(message), name, little_endian=True))


def from_cdr(cls: type[MessageT], data: bytes) -> MessageT:
    """Return the message of class ``cls`` that CDR bytes of either byte order hold. Thread-safe.

    Raises:
        ValueError: the bytes are no such message.
        NotImplementedError: the message contains wide strings, which rosbags does not decode.
    """
    from rosbags.serde import SerdeError

    name = cls.__type_name__
    try:
        return cast("MessageT", _store_with(cls).deserialize_cdr(data, name))
    except SerdeError as error:
        raise ValueError(f"these {len(data)} bytes hold no {name}: {error}") from None


def definition(cls: type[Message]) -> str:
    """Return a message's definition with all it contains, in the ``ros2msg`` form of MCAP schemas."""
    text, _ = _store_with(cls).generate_msgdef(cls.__type_name__, ros_version=2)
    return text


@cache
def _store() -> Typestore:
    from rosbags.typesys.store import Typestore

    return Typestore()


def _store_with(cls: type[Message]) -> Typestore:
    """Return the typestore after giving it a class and all that it contains."""
    store, interface = _store(), cls.__interface__
    name = cls.__type_name__
    if name not in store.fielddefs:
        with _lock:
            for part in interface.parts.values():
                _store_with(part)
            store.types[name] = cast("Any", lambda *values: _inward(cls, values))
            filler: Fielddefs = [(FILLER_FIELD, (Nodetype.BASE, ("uint8", 0)))]
            store.fielddefs[name] = (interface.definition.constants, interface.definition.fields or filler)
    return store


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
        raise NotImplementedError(f"rosbags does not encode wide strings ({of})")
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
    return _Coding(lambda values: [element.outward(value) for value in values], _unchanged)


def _unchanged(value: Any) -> Any:
    return value


def _signed(octet: bytes) -> int:
    return int.from_bytes(octet, "little", signed=True)


def _octet(number: int) -> bytes:
    return bytes([number & 0xFF])
