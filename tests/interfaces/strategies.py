"""Random messages, drawn from the fields' types."""

from __future__ import annotations

import math
from array import array
from functools import cache
from typing import Any

import numpy as np
from hypothesis import strategies as st

from sim.interfaces import Message, message_of_type
from sim.interfaces.field_types import (
    FLOAT_LIMITS,
    INTEGER_LIMITS,
    Array,
    BasicType,
    BoundedSequence,
    BoundedString,
    BoundedWString,
    ElementType,
    FieldType,
    NamespacedType,
    UnboundedSequence,
)
from sim.interfaces.sequences import typecode

# All that UTF-8 can carry; asking for the codec by its name takes seconds.
TEXT = st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\x00"), max_size=8)


@cache
def messages(cls: type[Message]) -> st.SearchStrategy[Any]:
    """Messages of a class with every field random; no NaN, so that they equal their copies."""
    fields = {name: _values(of) for name, of in cls.__interface__.types.items()}
    return st.builds(cls, **fields)


def _values(of: FieldType) -> st.SearchStrategy[Any]:
    if isinstance(of, Array):
        values = st.lists(_elements(of.value_type), min_size=of.size, max_size=of.size)
        code = typecode(of)
        return values if code is None else values.map(lambda items: np.array(items, np.dtype(code).name))
    if isinstance(of, BoundedSequence | UnboundedSequence):
        bound = min(of.maximum_size, 4) if isinstance(of, BoundedSequence) else 4
        values = st.lists(_elements(of.value_type), max_size=bound)
        code = typecode(of)
        return values if code is None else values.map(lambda items: array(code, items))
    return _elements(of)


def _elements(of: ElementType) -> st.SearchStrategy[Any]:
    if isinstance(of, NamespacedType):
        return messages(message_of_type("/".join(of.namespaced_name())))
    if isinstance(of, BasicType):
        return _basic(of.typename)
    return (
        TEXT.map(lambda text: text[: of.maximum_size])
        if isinstance(of, BoundedString | BoundedWString)
        else TEXT
    )


def _basic(typename: str) -> st.SearchStrategy[Any]:
    if typename in INTEGER_LIMITS:
        return st.integers(*INTEGER_LIMITS[typename])
    if typename == "octet":
        return st.binary(min_size=1, max_size=1)
    if typename == "boolean":
        return st.booleans()
    if typename == "double":
        return st.floats(allow_nan=False)
    # rosidl's limit, which has fewer digits, leaves out the very largest 32-bit float.
    return st.floats(allow_nan=False, width=32).filter(
        lambda v: math.isinf(v) or abs(v) <= FLOAT_LIMITS["float"]
    )
