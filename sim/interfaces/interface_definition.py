"""The content of a ``.msg`` file, or of a part of a ``.srv`` or ``.action`` file."""

import re
from collections.abc import Mapping
from typing import Literal, Protocol, TypeAlias

from attrs import field, frozen
from rosbags.interfaces import Nodetype
from rosbags.interfaces.typing import BaseDesc, Constdefs, Fielddefs, FieldDesc, NameDesc

from sim.interfaces.field_types import (
    Array,
    BasicType,
    BoundedSequence,
    BoundedString,
    BoundedWString,
    ElementType,
    FieldType,
    NamespacedType,
    UnboundedSequence,
    UnboundedString,
    UnboundedWString,
)

Kind: TypeAlias = Literal["msg", "srv", "action"]

_IDL_NAMES = {"bool": "boolean", "byte": "octet", "char": "uint8", "float32": "float", "float64": "double"}


FILLER_FIELD = "structure_needs_at_least_one_member"
"""The field that rosbags adds to a message without fields, as ROS 2's IDL does."""


class DefinitionError(ImportError, ValueError):
    """A ``.msg``, ``.srv`` or ``.action`` file cannot be used; the message names file, line and reason.

    It is also an `ImportError`, because the import of the class fails.
    """


class UnknownInterfaceError(LookupError):
    """No package, message, service or action has this name; the message names the most similar one."""


@frozen
class Definition:
    """One structure: a message, or a part of a service or an action.

    Constants and fields have rosbags' notation, so that its typestore can use them as they are.
    A structure without fields has none here (rosbags adds a filler byte).
    """

    package: str
    kind: Kind
    name: str
    constants: Constdefs
    fields: Fielddefs
    defaults: Mapping[str, object] = field(factory=dict)
    """Declared default values by field name; other fields default to zero, empty or false."""
    places: Mapping[str, str] = field(factory=dict, repr=False)
    """``file:line`` of each constant and field that was read from a file."""

    @property
    def type_name(self) -> str:
        """The full name, such as ``geometry_msgs/msg/Twist``."""
        return f"{self.package}/{self.kind}/{self.name}"

    @property
    def module_name(self) -> str:
        """The module of rosidl's Python class, such as ``geometry_msgs.msg._twist``."""
        owner = self.name if self.kind == "msg" else owner_of(self.name)
        return f"{self.package}.{self.kind}.{module_stem(owner)}"

    def place(self, name: str) -> str:
        """Return ``file:line`` of a constant or field for an error; without a file, the type's full name."""
        return self.places.get(name, self.type_name)

    def field_types(self) -> dict[str, FieldType]:
        """Return the type of every field by name, in the order of definition."""
        return {name: field_type(description) for name, description in self.fields}


class DefinitionSource(Protocol):
    """A source of definitions."""

    def packages(self) -> frozenset[str]:
        """Return the names of all packages of the source."""

    def names(self, package: str, kind: Kind) -> tuple[str, ...]:
        """Return the sorted names of a package's interfaces of one kind; empty for an unknown package."""

    def parts(self, package: str, kind: Kind, name: str) -> tuple[Definition, ...]:
        """Return the structures of an interface listed by ``names``; `DefinitionError` if its text is wrong.

        A message has one, a service has request and response, an action has goal, result and feedback.
        """

    def text(self, package: str, kind: Kind, name: str) -> str:
        """Return the definition of an interface listed by ``names``, as its author wrote it."""


def owner_of(name: str) -> str:
    """Return the service or action that a part belongs to: ``Fibonacci_SendGoal_Request`` → ``Fibonacci``."""
    return name.partition("_")[0]


def module_stem(name: str) -> str:
    """Return rosidl's file name for the module of an interface: ``SetBool`` → ``_set_bool``.

    Rule: rosidl_pycommon's ``convert_camel_case_to_lower_case_underscore``.
    """
    words = re.sub(r"(.)([A-Z][a-z]+)", r"\1_\2", name)
    words = re.sub(r"([a-z0-9])([A-Z])", r"\1_\2", words)
    return f"_{words.lower()}"


def field_type(description: FieldDesc) -> FieldType:
    """Convert rosbags' description of a field to the ROS 2 type."""
    if description[0] == Nodetype.BASE or description[0] == Nodetype.NAME:
        return _element_type(description)
    inner, size = description[1]
    assert isinstance(inner, tuple)
    assert isinstance(size, int)
    element = _element_type(inner)
    if description[0] == Nodetype.ARRAY:
        return Array(element, size)
    return BoundedSequence(element, size) if size else UnboundedSequence(element)


def _element_type(description: BaseDesc | NameDesc) -> ElementType:
    if description[0] == Nodetype.NAME:
        package, kind, name = description[1].split("/")
        return NamespacedType((package, kind), name)
    name, bound = description[1]
    if name == "string":
        return BoundedString(bound) if bound else UnboundedString()
    if name == "wstring":
        return BoundedWString(bound) if bound else UnboundedWString()
    return BasicType(_IDL_NAMES.get(name, name))
