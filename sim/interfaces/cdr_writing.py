"""Encodes messages as CDR. The steps that write the fields of a class are determined once.

Consecutive numbers, also those in nested messages, are packed in one call. Their alignment depends on the
texts and sequences before them, so every such run of numbers has a format for each of its eight possible
offsets. Source: OMG's CDR with alignments up to 8, as Fast CDR writes it for ROS 2.
"""

from collections.abc import Callable, Iterator, Sequence
from functools import cache
from operator import attrgetter
from struct import Struct, calcsize
from typing import Any, TypeAlias, cast

import numpy as np
from attrs import frozen

from sim.interfaces.base import Interface, Message
from sim.interfaces.field_types import (
    AbstractWString,
    Array,
    BasicType,
    ElementType,
    FieldType,
    NamespacedType,
    SequenceType,
)
from sim.interfaces.sequences import TYPECODES, typecode

Encode: TypeAlias = Callable[[Any], bytes]
_Write: TypeAlias = Callable[[Any, bytearray], None]
"""Appends a value to a buffer of CDR."""

_LITTLE_ENDIAN = b"\x00\x01\x00\x00"
"""The header with the byte order; alignments count from its end."""
_FORMATS = {"boolean": "?", "octet": "1s", **TYPECODES}
_PADDINGS = {size: tuple(bytes(-place % size) for place in range(8)) for size in (1, 2, 4, 8)}
"""The padding before a value of a size, by the offset modulo 8."""


@frozen
class _WriteStep:
    """``write`` appends the value that ``get`` returns for a message."""

    get: Callable[[Any], Any]
    write: _Write


@frozen
class _Number:
    """A number, truth value or byte, and the path of slots to it."""

    path: str
    format: str


@cache
def encoder_of(cls: type[Message]) -> Encode:
    """Return the thread-safe encoder for messages of a class."""
    pieces = list(_pieces(cls.__interface__, ""))
    if all(isinstance(piece, _Number) for piece in pieces):
        return _flat_encoder(cast("list[_Number]", pieces))
    steps = tuple((step.get, step.write) for step in _steps(pieces))

    def encode(message: Any) -> bytes:
        out = bytearray()
        for get, write in steps:
            write(get(message), out)
        return _LITTLE_ENDIAN + out

    return encode


def _flat_encoder(numbers: Sequence[_Number]) -> Encode:
    """Return the encoder of messages that contain only numbers."""
    pack = Struct("<4s" + _layout(numbers, 0)).pack
    get = _getter(numbers)
    if len(numbers) == 1:
        return lambda message: pack(_LITTLE_ENDIAN, get(message))
    return lambda message: pack(_LITTLE_ENDIAN, *get(message))


def _pieces(interface: Interface, path: str) -> Iterator[_Number | _WriteStep]:
    """Yield the parts of a message in order, with nested messages flattened."""
    for name, of in interface.types.items():
        slot = f"{path}_{name}"
        if isinstance(of, NamespacedType):
            yield from _pieces(interface.parts[of].__interface__, f"{slot}.")
        elif isinstance(of, BasicType):
            yield _Number(slot, _FORMATS[of.typename])
        else:
            yield _WriteStep(attrgetter(slot), _writer(name, of, interface))
    if not interface.types:
        yield _WriteStep(_nothing, _write_filler)


def _steps(pieces: Sequence[_Number | _WriteStep]) -> Iterator[_WriteStep]:
    """Yield the steps of writing; consecutive numbers are one step."""
    run: list[_Number] = []
    for piece in pieces:
        if isinstance(piece, _Number):
            run.append(piece)
            continue
        if run:
            yield _WriteStep(_getter(run), _write_run(run))
            run = []
        yield piece
    if run:
        yield _WriteStep(_getter(run), _write_run(run))


def _getter(numbers: Sequence[_Number]) -> Callable[[Any], Any]:
    """Return the function that gets the numbers: one number as it is, several as a tuple."""
    return attrgetter(*(number.path for number in numbers))


def _write_run(numbers: Sequence[_Number]) -> _Write:
    packs = tuple(Struct("<" + _layout(numbers, place)).pack for place in range(8))

    def write_one(value: Any, out: bytearray) -> None:
        out += packs[len(out) & 7](value)

    def write_several(values: Any, out: bytearray) -> None:
        out += packs[len(out) & 7](*values)

    return write_one if len(numbers) == 1 else write_several


def _layout(numbers: Sequence[_Number], place: int) -> str:
    """Return the format of numbers and their padding, from an offset modulo 8."""
    layout = ""
    for number in numbers:
        size = calcsize(f"<{number.format}")
        padding = -place % size
        layout += f"{padding}x{number.format}" if padding else number.format
        place += padding + size
    return layout


def _writer(name: str, of: FieldType, interface: Interface) -> _Write:
    """Return the function that writes a field which is neither a number nor a message."""
    if not isinstance(of, SequenceType):
        return _write_wide_text if isinstance(of, AbstractWString) else _write_text
    code = typecode(of)
    if code is not None:
        size = np.dtype(code).itemsize
        return _write_array(size) if isinstance(of, Array) else _write_numbers(size)
    values = _values_writer(of.value_type, interface)
    return _counted(name, of.size, values) if isinstance(of, Array) else _with_count(values)


def _values_writer(of: ElementType, interface: Interface) -> Callable[[Any, bytearray], None]:
    """Return the function that writes the values of a sequence."""
    if isinstance(of, NamespacedType):
        return _write_messages(interface.parts[of].__interface__)
    if isinstance(of, BasicType):
        return _write_truths if of.typename == "boolean" else _write_octets
    write = _write_wide_text if isinstance(of, AbstractWString) else _write_text

    def write_texts(values: Any, out: bytearray) -> None:
        for value in values:
            write(value, out)

    return write_texts


def _write_messages(interface: Interface) -> _Write:
    steps = tuple((step.get, step.write) for step in _steps(list(_pieces(interface, ""))))

    def write(messages: Any, out: bytearray) -> None:
        for message in messages:
            for get, write_part in steps:
                write_part(get(message), out)

    return write


def _with_count(write_values: _Write) -> _Write:
    def write(values: Any, out: bytearray) -> None:
        _write_length(len(values), out)
        write_values(values, out)

    return write


def _counted(name: str, size: int, write_values: _Write) -> _Write:
    """Return the function that writes exactly ``size`` values."""

    def write(values: Any, out: bytearray) -> None:
        # The length was checked at assignment, but the program may have changed the list since.
        if len(values) != size:
            raise ValueError(f"the field '{name}' holds {len(values)} values and must hold {size}")
        write_values(values, out)

    return write


def _write_numbers(size: int) -> _Write:
    """Return the function that writes an ``array.array`` of numbers with ``size`` bytes each."""
    paddings = _PADDINGS[size]

    def write(values: Any, out: bytearray) -> None:
        _write_length(len(values), out)
        if values:
            out += paddings[len(out) & 7]
            out += values

    return write


def _write_array(size: int) -> _Write:
    """Return the function that writes a numpy array of numbers with ``size`` bytes each."""
    paddings = _PADDINGS[size]

    def write(values: Any, out: bytearray) -> None:
        out += paddings[len(out) & 7]
        out += values.tobytes()

    return write


_pack_length = tuple(Struct(f"<{-place % 4}xI").pack for place in range(4))


def _write_length(length: int, out: bytearray) -> None:
    out += _pack_length[len(out) & 3](length)


def _write_text(text: str, out: bytearray) -> None:
    data = text.encode()
    out += _pack_length[len(out) & 3](len(data) + 1)
    out += data
    out += b"\0"


def _write_wide_text(text: str, out: bytearray) -> None:
    units = np.frombuffer(text.encode("utf-16-le", "surrogatepass"), "<u2")
    _write_length(len(units), out)
    out += units.astype("<u4").tobytes()


def _write_truths(values: Any, out: bytearray) -> None:
    out += bytes(map(bool, values))


def _write_octets(values: Any, out: bytearray) -> None:
    out += b"".join(values)


def _write_filler(_nothing: None, out: bytearray) -> None:
    out += b"\0"


def _nothing(_message: Any) -> None:
    """Get the value of the filler: None."""
