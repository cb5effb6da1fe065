"""Converts the constants and default values of a definition to Python values."""

from typing import Any

from rosbags.interfaces import Nodetype

from sim.interfaces.elements import Check, check_of, plain_rules
from sim.interfaces.field_types import BasicType, ElementType, FieldType, NamespacedType, SequenceType
from sim.interfaces.interface_definition import Definition, DefinitionError, field_type


def constant_values(definition: Definition) -> dict[str, Any]:
    """Return the constants of a definition; constants of type ``byte`` are bytes, as in rosidl.

    Raises:
        DefinitionError: a constant does not fit its type.
    """
    values = {}
    for name, typename, literal in definition.constants:
        of = field_type((Nodetype.BASE, (typename, 0)))
        assert not isinstance(of, NamespacedType | SequenceType)
        values[name] = _fitted(definition, name, literal, of, check_of(name, plain_rules(of)))
    return values


def default_value(definition: Definition, field: str, of: FieldType, check: Check) -> Any:
    """Return the value to store for a field's declared default.

    Raises:
        DefinitionError: the default does not fit the field's type.
    """
    return _fitted(definition, field, definition.defaults[field], of, check)


def _fitted(definition: Definition, name: str, literal: object, of: FieldType, check: Check) -> Any:
    try:
        if not isinstance(of, SequenceType):
            return check(_converted(literal, of))
        items = literal if isinstance(literal, list) else [literal]
        return check([_converted(item, of.value_type) for item in items])
    except (AssertionError, ValueError, TypeError) as error:
        raise DefinitionError(f"{definition.place(name)}: {literal!r} cannot be used: {error}") from None


def _converted(literal: Any, of: ElementType) -> Any:
    """Convert a literal to its type's class: ``1`` means ``1.0`` for a float, ``True`` for a bool."""
    if isinstance(of, NamespacedType):
        raise TypeError(f"a field of type {of} has no literal")
    if not isinstance(of, BasicType):
        return str(literal)
    if of.typename in ("float", "double"):
        return float(literal)
    if of.typename == "octet":
        return bytes([literal])
    if of.typename == "boolean" and literal in (0, 1):
        return bool(literal)
    return literal
