"""Making a message class from its definition."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from operator import attrgetter
from typing import Any

from attrs import evolve

from sim.interfaces.base import Interface, Message
from sim.interfaces.elements import check_of, message_element, plain_element
from sim.interfaces.field_types import FieldType, NamespacedType, SequenceType, element_type
from sim.interfaces.interface_definition import Definition, DefinitionError, UnknownInterfaceError
from sim.interfaces.literals import constant_values, default_value
from sim.interfaces.sequences import Handling, handling_of

FindMessage = Callable[[NamespacedType], type[Message]]
"""Returns the class of a message that another one contains; `UnknownInterfaceError` if it cannot."""

_Puts = Mapping[str, Callable[[Any, Any], None]]
"""Stores a value in a message's slot, unchecked, by field name."""


def build_class(definition: Definition, find_message: FindMessage) -> type[Message]:
    """Return a new class for a definition.

    Raises:
        DefinitionError: a constant or default value does not fit its type, or a field's type is unknown.
    """
    types = definition.field_types()
    parts = _parts(definition, types, find_message)
    handlings = {
        name: _with_declared_default(definition, name, of, _handling(name, of, parts))
        for name, of in types.items()
    }
    cls = _bare_class(definition, types, handlings)
    puts = {name: vars(cls)[f"_{name}"].__set__ for name in types}
    for name, handling in handlings.items():
        setattr(cls, name, property(attrgetter(f"_{name}"), _setter(puts[name], handling)))
    init = _initialiser(handlings, puts)
    init.__qualname__ = f"{cls.__name__}.__init__"
    cls.__init__ = init  # type: ignore[method-assign]
    fixed_names = frozenset(
        (*(constant for constant, _, _ in definition.constants), *map(_default_name, definition.defaults))
    )
    copier = _copier(cls, handlings, puts)
    cls.__interface__ = Interface(definition, types, parts, handlings, fixed_names, copier)
    return cls


def _parts(
    definition: Definition, types: Mapping[str, FieldType], find_message: FindMessage
) -> dict[NamespacedType, type[Message]]:
    parts: dict[NamespacedType, type[Message]] = {}
    for name, of in types.items():
        inner = element_type(of)
        if isinstance(inner, NamespacedType):
            try:
                parts[inner] = find_message(inner)
            except UnknownInterfaceError as error:
                raise DefinitionError(f"{definition.place(name)}: the field {name!r}: {error}") from None
    return parts


def _bare_class(
    definition: Definition, types: Mapping[str, FieldType], handlings: Mapping[str, Handling]
) -> type[Message]:
    """Return the class with slots and constants, without behaviour of its fields."""
    defaults = {_default_name(name): handlings[name].make() for name in definition.defaults}
    return type(
        definition.name,
        (Message,),
        {
            "__slots__": tuple(f"_{name}" for name in types),
            "__module__": definition.module_name,
            "__doc__": f"Message class for {definition.type_name}; see `Message`.",
            "__type_name__": definition.type_name,
            "SLOT_TYPES": tuple(types.values()),
            "_fields_and_field_types": {name: str(of) for name, of in types.items()},
            **constant_values(definition),
            **defaults,
        },
    )


def _default_name(field: str) -> str:
    """Return the name of the class attribute with a field's declared default value."""
    return f"{field.upper()}__DEFAULT"


def _setter(put: Callable[[Any, Any], None], handling: Handling) -> Callable[[Any, Any], None]:
    check = handling.check

    def set_field(message: Any, value: Any) -> None:
        put(message, check(value))

    return set_field


def _initialiser(handlings: Mapping[str, Handling], puts: _Puts) -> Callable[..., None]:
    steps = tuple((name, puts[name], handling.make, handling.check) for name, handling in handlings.items())
    known = frozenset(handlings)

    def initialise(self: Message, /, **values: Any) -> None:
        if not values.keys() <= known:
            _require_known(values, known)
        for name, put, make, check in steps:
            put(self, check(values[name]) if name in values else make())

    return initialise


def _require_known(values: Mapping[str, Any], known: frozenset[str]) -> None:
    if unknown := values.keys() - known - {"check_fields"}:
        raise AssertionError(f"Invalid arguments passed to constructor: {', '.join(sorted(unknown))}")
    if not values["check_fields"]:
        raise NotImplementedError("check_fields=False is not supported: every field is always checked")


def _copier(cls: type[Message], handlings: Mapping[str, Handling], puts: _Puts) -> Callable[[Any], Any]:
    steps = tuple((puts[name], handling.copy, attrgetter(f"_{name}")) for name, handling in handlings.items())
    new = cls.__new__

    def copy(message: Any) -> Any:
        duplicate = new(cls)
        for put, copy_value, get in steps:
            put(duplicate, copy_value(get(message)))
        return duplicate

    return copy


def _handling(field: str, of: FieldType, parts: Mapping[NamespacedType, type[Message]]) -> Handling:
    inner = element_type(of)
    element = message_element(parts[inner]) if isinstance(inner, NamespacedType) else plain_element(inner)
    if isinstance(of, SequenceType):
        return handling_of(field, of, element)
    return Handling(check_of(field, element), element.make, element.copy)


def _with_declared_default(definition: Definition, field: str, of: FieldType, handling: Handling) -> Handling:
    if field not in definition.defaults:
        return handling
    value = default_value(definition, field, of, handling.check)
    copied = isinstance(of, SequenceType)
    return evolve(handling, make=(lambda: handling.copy(value)) if copied else (lambda: value))
