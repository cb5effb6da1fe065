"""Builds a message class from its definition."""

from collections.abc import Callable, Mapping
from operator import attrgetter
from typing import Any

from attrs import evolve

from sim.interfaces.base import Interface, Message
from sim.interfaces.elements import check_of, message_rules, plain_rules
from sim.interfaces.field_types import FieldType, NamespacedType, SequenceType, element_type
from sim.interfaces.interface_definition import Definition, DefinitionError, UnknownInterfaceError
from sim.interfaces.literals import constant_values, default_value
from sim.interfaces.sequences import FieldRules, sequence_rules

FindMessage = Callable[[NamespacedType], type[Message]]
"""Returns the class of a contained message; raises `UnknownInterfaceError` without such a message."""

_Puts = Mapping[str, Callable[[Any, Any], None]]
"""Stores a value in a message's slot, unchecked, by field name."""


def build_class(definition: Definition, find_message: FindMessage) -> type[Message]:
    """Return a new class for a definition.

    Raises:
        DefinitionError: a constant or default value does not fit its type, or a field's type is unknown.
    """
    types = definition.field_types()
    parts = _parts(definition, types, find_message)
    field_rules = {
        name: _with_declared_default(definition, name, of, _field_rules(name, of, parts))
        for name, of in types.items()
    }
    cls = _bare_class(definition, types, field_rules)
    puts = {name: vars(cls)[f"_{name}"].__set__ for name in types}
    for name, rules in field_rules.items():
        setattr(cls, name, property(attrgetter(f"_{name}"), _setter(puts[name], rules)))
    init = _initialiser(field_rules, puts)
    init.__qualname__ = f"{cls.__name__}.__init__"
    cls.__init__ = init  # type: ignore[method-assign]
    fixed_names = frozenset(
        (*(constant for constant, _, _ in definition.constants), *map(_default_name, definition.defaults))
    )
    copier = _copier(cls, field_rules, puts)
    cls.__interface__ = Interface(definition, types, parts, field_rules, fixed_names, copier)
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
    definition: Definition, types: Mapping[str, FieldType], field_rules: Mapping[str, FieldRules]
) -> type[Message]:
    """Return the class with slots and constants, without properties for its fields."""
    defaults = {_default_name(name): field_rules[name].make() for name in definition.defaults}
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


def _setter(put: Callable[[Any, Any], None], rules: FieldRules) -> Callable[[Any, Any], None]:
    check = rules.check

    def set_field(message: Any, value: Any) -> None:
        put(message, check(value))

    return set_field


def _initialiser(field_rules: Mapping[str, FieldRules], puts: _Puts) -> Callable[..., None]:
    steps = tuple((name, puts[name], rules.make, rules.check) for name, rules in field_rules.items())
    known = frozenset(field_rules)

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


def _copier(cls: type[Message], field_rules: Mapping[str, FieldRules], puts: _Puts) -> Callable[[Any], Any]:
    steps = tuple((puts[name], rules.copy, attrgetter(f"_{name}")) for name, rules in field_rules.items())
    new = cls.__new__

    def copy(message: Any) -> Any:
        duplicate = new(cls)
        for put, copy_value, get in steps:
            put(duplicate, copy_value(get(message)))
        return duplicate

    return copy


def _field_rules(field: str, of: FieldType, parts: Mapping[NamespacedType, type[Message]]) -> FieldRules:
    inner = element_type(of)
    element = message_rules(parts[inner]) if isinstance(inner, NamespacedType) else plain_rules(inner)
    if isinstance(of, SequenceType):
        return sequence_rules(field, of, element)
    return FieldRules(check_of(field, element), element.make, element.copy)


def _with_declared_default(
    definition: Definition, field: str, of: FieldType, rules: FieldRules
) -> FieldRules:
    if field not in definition.defaults:
        return rules
    value = default_value(definition, field, of, rules.check)
    copied = isinstance(of, SequenceType)
    return evolve(rules, make=(lambda: rules.copy(value)) if copied else (lambda: value))
