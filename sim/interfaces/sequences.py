"""Rules for lists and arrays in a field: checking, default and copy. The error texts are rosidl's.

Numbers are stored in an ``array.array``, or in a numpy array if their count is fixed. All
other values, also truth values and bytes, stay in the assigned list, tuple or set.
"""

from __future__ import annotations

from array import array
from collections import UserList, UserString
from collections.abc import Callable, Sequence, Set
from typing import Any

import numpy as np
from attrs import frozen

from sim.interfaces.elements import Check, ValueRules
from sim.interfaces.field_types import (
    FLOAT_LIMITS,
    INTEGER_LIMITS,
    Array,
    BasicType,
    BoundedSequence,
    SequenceType,
)

TYPECODES = {
    "float": "f",
    "double": "d",
    "int8": "b",
    "uint8": "B",
    "int16": "h",
    "uint16": "H",
    "int32": "i",
    "uint32": "I",
    "int64": "q",
    "uint64": "Q",
}
"""The codes of ``array`` and ``struct`` for the types of numbers."""


@frozen
class FieldRules:
    """How a field checks, makes and copies its value."""

    check: Check
    make: Callable[[], Any]
    """Returns the default value."""
    copy: Callable[[Any], Any]
    """Returns the value as a subscriber receives it."""


def typecode(of: SequenceType) -> str | None:
    """Return the ``array.array`` type code of a sequence of numbers; ``None`` for other sequences."""
    return TYPECODES.get(of.value_type.typename) if isinstance(of.value_type, BasicType) else None


def sequence_rules(field: str, of: SequenceType, element: ValueRules) -> FieldRules:
    """Return the rules of a field of this sequence type."""
    code = typecode(of)
    if code is None:
        count, make, copy = (of.size if isinstance(of, Array) else 0), element.make, element.copy
        return FieldRules(
            _check_items(field, of, element),
            lambda: [make() for _ in range(count)],
            lambda values: [copy(value) for value in values],
        )
    if isinstance(of, Array):
        # By name, because numpy has two types of 64-bit integers with different reprs.
        size, dtype = of.size, np.dtype(np.dtype(code).name)
        return FieldRules(
            _check_fixed(field, of, dtype, element),
            lambda: np.zeros(size, dtype),
            lambda values: values.copy(),
        )
    return FieldRules(_check_numbers(field, of, code, element), lambda: array(code), lambda values: values[:])


def _complaint(field: str, of: SequenceType, element: ValueRules) -> str:
    """Return the error text for a value that is not a collection of valid values."""
    length = ""
    if isinstance(of, Array):
        length = f" with length {of.size}"
    elif isinstance(of, BoundedSequence):
        length = f" with length <= {of.maximum_size}"
    each = f" and {element.each}" if element.each else ""
    of_class = f" and each value of type '{element.name}'"
    # rosidl writes the limit of a text's length before the class, and limits of numbers after it.
    details = each + of_class if element.python is str else of_class + each
    return f"The '{field}' field must be a set or sequence{length}{details}"


def _check_items(field: str, of: SequenceType, element: ValueRules) -> Check:
    """Return the check of count, class and range of the values; it returns the values themselves."""
    python, all_within, fits = element.python, element.all_within, _length_rule(of)
    complaint = _complaint(field, of, element)

    def check(values: Any) -> Any:
        if (
            _is_collection(values)
            and fits(len(values))
            and all(issubclass(cls, python) for cls in set(map(type, values)))
            and (all_within is None or all_within(values))
        ):
            return values
        raise AssertionError(complaint)

    return check


def _check_numbers(field: str, of: SequenceType, code: str, element: ValueRules) -> Check:
    """Return the check of a sequence of numbers; it returns an ``array.array``.

    Buffers of numbers are checked in one piece, since pictures have millions of them.
    """
    check_items, fits = _check_items(field, of, element), _length_rule(of)
    complaint = _complaint(field, of, element)
    wrong_code = f"The '{field}' array.array() must have the type code of '{code}'"
    too_long = f"The '{field}' array.array() must have a size <= {getattr(of, 'maximum_size', 0)}"
    number, native = str(of.value_type), np.dtype(code)

    def check(values: Any) -> array[Any]:
        if isinstance(values, array):
            if values.typecode != code:
                raise AssertionError(wrong_code)
            if not fits(len(values)):
                raise AssertionError(too_long)
            return values
        if isinstance(values, bytes | bytearray):
            values = memoryview(values)
        if isinstance(values, memoryview):
            values = np.asarray(values)
        if isinstance(values, np.ndarray):
            fitting = values.dtype == native and values.ndim == 1
            if not fits(values.size) or not (fitting or _holds(values, number)):
                raise AssertionError(complaint)
            return array(code, values.astype(native, copy=False).tobytes())
        # A list, because an array would read bytes as raw memory.
        return array(code, list(check_items(values)))

    return check


def _check_fixed(field: str, of: Array, dtype: np.dtype[Any], element: ValueRules) -> Check:
    """Return the check of a fixed count of numbers; it returns a numpy array."""
    check_items, size = _check_items(field, of, element), of.size
    wrong_dtype = f"The '{field}' numpy.ndarray() must have the dtype of 'numpy.{dtype.name}'"
    wrong_size = f"The '{field}' numpy.ndarray() must have a size of {size}"

    def check(values: Any) -> np.ndarray[Any, Any]:
        if isinstance(values, np.ndarray):
            if values.dtype != dtype:
                raise AssertionError(wrong_dtype)
            if values.size != size:
                raise AssertionError(wrong_size)
            return values
        return np.array(list(check_items(values)), dtype)

    return check


def _length_rule(of: SequenceType) -> Callable[[int], bool]:
    """Return the check of the number of values."""
    if isinstance(of, Array):
        return of.size.__eq__
    return of.maximum_size.__ge__ if isinstance(of, BoundedSequence) else lambda _: True


def _is_collection(values: Any) -> bool:
    if isinstance(values, list | tuple | array):
        return True
    return isinstance(values, Sequence | Set | UserList) and not isinstance(values, str | UserString)


def _holds(values: np.ndarray[Any, Any], typename: str) -> bool:
    """Whether a numpy array is one-dimensional and all its numbers fit the type."""
    if values.ndim != 1 or values.dtype.kind not in ("f" if typename in FLOAT_LIMITS else "iu"):
        return False
    if typename in INTEGER_LIMITS:
        low, high = INTEGER_LIMITS[typename]
        return not values.size or (low <= int(values.min()) and int(values.max()) <= high)
    magnitudes = np.abs(values)
    return not np.any((magnitudes > FLOAT_LIMITS[typename]) & (magnitudes < np.inf))
