"""Rules for a single value of a field: checking, default and copy. The error texts are rosidl's."""

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
"""Takes an assigned value and returns the value to store; raises `AssertionError` with rosidl's text."""


@frozen
class ValueRules:
    """The rules for one value, in a field or in a sequence."""

    python: type | tuple[type, ...]
    """The class, or classes, of accepted values."""
    name: str
    """The class's name in the error text of a sequence."""
    wanted: str
    """What the field must be: the error text for a value of another class."""
    make: Callable[[], Any]
    """Returns the default value."""
    copy: Callable[[Any], Any]
    """Returns the value as a subscriber receives it."""
    within: Callable[[Any], bool] | None = None
    """Whether a value of the right class is in range; ``None`` if all values are."""
    all_within: Callable[[Collection[Any]], bool] | None = None
    """The same for many values at once."""
    limit: str = ""
    """What the field must be: the error text for a value out of range."""
    each: str = ""
    """What each value of a sequence must be, besides its class."""


def check_of(field: str, element: ValueRules) -> Check:
    """Return the check of a field with a single value."""
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
def plain_rules(of: BasicType | StringType) -> ValueRules:
    """Return the rules of a number, truth value, byte or text."""
    if not isinstance(of, BasicType):
        return _string(of)
    if of.typename in INTEGER_LIMITS:
        return _integer(of.typename)
    if of.typename in FLOAT_LIMITS:
        return _floating_point(of.typename)
    return ValueRules(bool, "bool", "of type 'bool'", bool, bool) if of.typename == "boolean" else _octet()


def message_rules(cls: type[Any]) -> ValueRules:
    """Return the rules of a message inside a message."""
    return ValueRules(
        cls, cls.__name__, f"a sub message of type '{cls.__name__}'", cls, cls.__interface__.copy
    )


def _string(of: StringType) -> ValueRules:
    if not isinstance(of, BoundedString | BoundedWString):
        return ValueRules(str, "str", "of type 'str'", str, str)
    bound = of.maximum_size
    text = f"string value not longer than {bound}"
    return ValueRules(
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


def _integer(typename: str) -> ValueRules:
    low, high = INTEGER_LIMITS[typename]
    noun = "integer" if low else "unsigned integer"
    return ValueRules(
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


def _floating_point(typename: str) -> ValueRules:
    bound = FLOAT_LIMITS[typename]
    each = f"each {typename} in [{-bound:f}, {bound:f}]"
    if typename == "double":
        return ValueRules(float, "float", "of type 'float'", float, float, each=each)
    single = Struct("f")
    pack, unpack = single.pack, single.unpack

    def all_within(values: Collection[float]) -> bool:
        # The first test is fast, but fails for infinities, which are allowed.
        return not values or max(map(abs, values)) <= bound or not any(bound < abs(v) < inf for v in values)

    return ValueRules(
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


def _octet() -> ValueRules:
    text = "of type 'bytes' or 'ByteString' with length 1"
    return ValueRules(
        (bytes, bytearray),
        "bytes",
        text,
        lambda: b"\x00",
        bytes,
        within=lambda value: len(value) == 1,
        all_within=lambda values: all(len(value) == 1 for value in values),
        limit=text,
    )
