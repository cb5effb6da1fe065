"""Test messages of test_msgs: for each type an empty message and one with a value in every field."""

from typing import Any

from sim.interfaces import Message, message, names
from sim.interfaces.field_types import (
    INTEGER_LIMITS,
    AbstractGenericString,
    AbstractNestedType,
    AbstractWString,
    Array,
    BasicType,
    NamespacedType,
)

_PACKAGE = "test_msgs"
_SEVERAL = 3
"""The number of values in a sequence; the bounded sequences of test_msgs allow as many."""


def get_test_msg(message_name: str) -> list[Message]:
    """Test messages of a type; NotImplementedError if test_msgs has no such message."""
    if message_name not in names(_PACKAGE, "msg"):
        raise NotImplementedError(f"{_PACKAGE} has no message {message_name}")
    kind = message(_PACKAGE, message_name)
    return [kind(), _filled(kind)]


def _filled(kind: type[Message]) -> Message:
    return kind(**{name: _value(of) for name, of in kind.__interface__.types.items()})


def _value(of: Any) -> Any:
    if isinstance(of, AbstractNestedType):
        count = of.size if isinstance(of, Array) else _SEVERAL
        return [_value(of.value_type) for _ in range(count)]
    if isinstance(of, NamespacedType):
        return _filled(message(of.namespaces[0], of.name))
    if isinstance(of, AbstractGenericString):
        return "Hellö wörld!" if isinstance(of, AbstractWString) else "Hello world!"
    assert isinstance(of, BasicType)
    if of.typename in INTEGER_LIMITS:
        return INTEGER_LIMITS[of.typename][1]
    return {"boolean": True, "octet": b"\xff", "float": 1.125, "double": 1.125}[of.typename]
