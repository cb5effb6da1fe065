"""The types of message fields, with the names of ROS 2's IDL.

The classes and their attributes match ``rosidl_parser.definition``, because programs see
them in ``SLOT_TYPES``. ``str()`` of a type is its text in ``get_fields_and_field_types()``.

``isinstance`` and ``issubclass`` answer as for rosidl's classes, whose hierarchy is five deep: here texts and
sequences are registered as virtual subclasses of the bases above them.
"""

from __future__ import annotations

from abc import ABC
from collections.abc import Iterable
from typing import Final, TypeAlias

from attrs import field, frozen

INTEGER_LIMITS: Final = {
    **{f"int{bits}": (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1) for bits in (8, 16, 32, 64)},
    **{f"uint{bits}": (0, 2**bits - 1) for bits in (8, 16, 32, 64)},
}
"""Smallest and largest value of every integer type."""

FLOAT_LIMITS: Final = {"float": 3.402823466e38, "double": 1.7976931348623157e308}
"""Largest finite magnitude of every floating point type, with rosidl's digits."""


class AbstractType(ABC):  # noqa: B024 -- programs only use it in isinstance()
    """Any type."""


class AbstractNestableType(AbstractType):
    """The type of a single value, which a sequence can contain."""


@AbstractNestableType.register
class AbstractGenericString(ABC):  # noqa: B024
    """A text."""

    def has_maximum_size(self) -> bool:
        """Whether the text's length is bounded."""
        return hasattr(self, "maximum_size")


class AbstractString(AbstractGenericString):
    """A text of 8-bit units."""


class AbstractWString(AbstractGenericString):
    """A text of 16-bit units."""


@AbstractType.register
class AbstractNestedType(ABC):
    """Several values of one type."""

    value_type: ElementType

    def has_maximum_size(self) -> bool:
        """Whether the number of values is bounded."""
        return hasattr(self, "maximum_size") or hasattr(self, "size")


class AbstractSequence(AbstractNestedType):
    """Any number of values, or any number up to a bound."""


@frozen
class BasicType(AbstractNestableType):
    """A number, a truth value (``boolean``) or one raw byte (``octet``)."""

    typename: str

    def __str__(self) -> str:
        return self.typename


def _as_tuple(names: Iterable[str]) -> tuple[str, ...]:
    return tuple(names)


@frozen
class NamespacedType(AbstractNestableType):
    """Another message: ``NamespacedType(("geometry_msgs", "msg"), "Point")``."""

    namespaces: tuple[str, ...] = field(converter=_as_tuple)
    name: str

    def namespaced_name(self) -> tuple[str, ...]:
        """Return package, kind and name as one tuple."""
        return (*self.namespaces, self.name)

    def __str__(self) -> str:
        return f"{self.namespaces[0]}/{self.name}"


@frozen
class UnboundedString(AbstractString):
    """Text of any length."""

    def __str__(self) -> str:
        return "string"


@frozen
class BoundedString(AbstractString):
    """Text of at most ``maximum_size`` characters."""

    maximum_size: int

    def __str__(self) -> str:
        return f"string<{self.maximum_size}>"


@frozen
class UnboundedWString(AbstractWString):
    """Wide (UTF-16) text of any length."""

    def __str__(self) -> str:
        return "wstring"


@frozen
class BoundedWString(AbstractWString):
    """Wide (UTF-16) text of at most ``maximum_size`` characters."""

    maximum_size: int

    def __str__(self) -> str:
        return f"wstring<{self.maximum_size}>"


StringType: TypeAlias = UnboundedString | BoundedString | UnboundedWString | BoundedWString
ElementType: TypeAlias = BasicType | NamespacedType | StringType


@frozen
class Array(AbstractNestedType):
    """Exactly ``size`` values."""

    value_type: ElementType
    size: int

    def __str__(self) -> str:
        return f"{self.value_type}[{self.size}]"


@frozen
class BoundedSequence(AbstractSequence):
    """At most ``maximum_size`` values."""

    value_type: ElementType
    maximum_size: int

    def __str__(self) -> str:
        return f"sequence<{self.value_type}, {self.maximum_size}>"


@frozen
class UnboundedSequence(AbstractSequence):
    """Any number of values."""

    value_type: ElementType

    def __str__(self) -> str:
        return f"sequence<{self.value_type}>"


SequenceType: TypeAlias = Array | BoundedSequence | UnboundedSequence
FieldType: TypeAlias = ElementType | SequenceType


def element_type(of: FieldType) -> ElementType:
    """Return the type of the values in a sequence; of any other type, the type itself."""
    return of.value_type if isinstance(of, SequenceType) else of
