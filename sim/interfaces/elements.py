"""How a single value of a field is recognised, made and copied; the error texts are rosidl's."""

from __future__ import annotations

from collections.abc import Callable, Collection
from functools import cache
from math import inf
from struct import Struct
from typing import Any, TypeAlias

from attrs import frozen

from sim.interfaces.field_types import (
    FLOAT_LIMITS,
    INTEGER_LIMITS,
    BasicType,
    BoundedString,
    BoundedWString,
    StringType,
)

Check: TypeAlias = Callable[[Any], Any]
"""Takes an assigned value, returns the value to store, raises `AssertionError` with rosidl's text."""


@frozen
class Element:
    """The rules for one value, whichever field or sequence it stands in."""

    python: type | tuple[type, ...]
    """Instances of it are taken."""
    name: str
    """Its name in the error text of a sequence."""
    wanted: str
    """What the field must be, for a value of another class."""
    make: Callable[[], Any]
    """Returns the default value."""
    copy: Callable[[Any], Any]
    """Returns the value as a subscriber receives it."""
    within: Callable[[Any], bool] | None = None
    """Whether a value of the right class is in range; ``None`` if every one is."""
    all_within: Callable[[Collection[Any]], bool] | None = None
    """The same for many values at once."""
    limit: str = ""
    """What the field must be, for a value out of range."""
    each: str = ""
    """What each value of a sequence must be, beside its class."""


def check_of(field: str, element: Element) -> Check:
    """Return the check of a field that holds one value."""
    python, within = element.python, element.within
    wrong_class = f"The '{field}' field must be {element.wanted}"
    out_of_range = f"The '{field}' field must be {element.limit}"

    def check_class(value: Any) -> Any:
        if isinstance(value, python):
            return value
        raise AssertionError(wrong_class)

    if within is None:
        return check_class

    def check_class_and_range(value: Any) -> Any:
        if isinstance(value, python):
            if within(value):
                return value
            raise AssertionError(out_of_range)
        raise AssertionError(wrong_class)

    return check_class_and_range


@cache
def plain_element(of: BasicType | StringType) -> Element:
    """Return the rules of a number, truth value, byte or text."""
    if not isinstance(of, BasicType):
        return _string(of)
    if of.typename in INTEGER_LIMITS:
        return _integer(of.typename)
    if of.typename in FLOAT_LIMITS:
        return _floating_point(of.typename)
    return Element(bool, "bool", "of type 'bool'", bool, bool) if of.typename == "boolean" else _octet()


def message_element(cls: type[Any]) -> Element:
    """Return the rules of a message inside a message."""
    return Element(cls, cls.__name__, f"a sub message of type '{cls.__name__}'", cls, cls.__interface__.copy)


def _string(of: StringType) -> Element:
    if not isinstance(of, BoundedString | BoundedWString):
        return Element(str, "str", "of type 'str'", str, str)
    bound = of.maximum_size
    text = f"string value not longer than {bound}"
    return Element(
        str,
        "str",
        text,
        str,
        str,
        within=lambda value: len(value) <= bound,
        all_within=lambda values: all(len(value) <= bound for value in values),
        limit=text,
        each=f"each {text}",
    )


def _integer(typename: str) -> Element:
    low, high = INTEGER_LIMITS[typename]
    noun = "integer" if low else "unsigned integer"
    return Element(
        int,
        "int",
        "of type 'int'",
        int,
        int,
        within=lambda value: low <= value <= high,
        all_within=lambda values: not values or (low <= min(values) and max(values) <= high),
        limit=f"an {noun} in [{low}, {high}]",
        each=f"each {noun} in [{low}, {high}]",
    )


def _floating_point(typename: str) -> Element:
    bound = FLOAT_LIMITS[typename]
    each = f"each {typename} in [{-bound:f}, {bound:f}]"
    if typename == "double":
        return Element(float, "float", "of type 'float'", float, float, each=each)
    single = Struct("f")
    pack, unpack = single.pack, single.unpack

    def all_within(values: Collection[float]) -> bool:
        # The first test is the quick one; infinities, which are allowed, fail it.
        return not values or max(map(abs, values)) <= bound or not any(bound < abs(v) < inf for v in values)

    return Element(
        float,
        "float",
        "of type 'float'",
        float,
        lambda value: unpack(pack(value))[0],
        within=lambda value: not bound < abs(value) < inf,
        all_within=all_within,
        limit=f"a float in [{-bound}, {bound}]",
        each=each,
    )


def _octet() -> Element:
    text = "of type 'bytes' or 'ByteString' with length 1"
    return Element(
        (bytes, bytearray),
        "bytes",
        text,
        lambda: b"\x00",
        bytes,
        within=lambda value: len(value) == 1,
        all_within=lambda values: all(len(value) == 1 for value in values),
        limit=text,
    )
