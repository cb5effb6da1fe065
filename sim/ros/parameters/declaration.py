"""Reads one entry of ``declare_parameters``."""

import warnings
from typing import Any, NamedTuple

from sim.interfaces import rcl_interfaces
from sim.ros.parameters.parameter import Parameter, parameter_value_to_python

_NAME_ONLY = (
    "when declaring parameter named '{}', declaring a parameter only providing its name is deprecated. "
    "You have to either:\n"
    '\t- Pass a name and a default value different to "PARAMETER NOT SET" (and optionally a descriptor).\n'
    "\t- Pass a name and a parameter type.\n"
    "\t- Pass a name and a descriptor with `dynamic_typing=True"
)


class Declaration(NamedTuple):
    """A declared parameter: its name without namespace, default value, and descriptor with the type."""

    name: str
    value: Any
    descriptor: Any


def read_declaration(index: int, entry: tuple[Any, ...]) -> Declaration:
    """Read (name,), (name, value or type) or (name, value or type, descriptor).

    Raises:
        TypeError, ValueError: the entry has another form, or contradicts itself.
    """
    if not 1 <= len(entry) <= 3:
        raise TypeError(
            f"Invalid parameter tuple length at index {index} in parameters list: {entry}; "
            "expecting length between 1 and 3"
        )
    name, second, descriptor = (*entry, None, None)[:3]
    if len(entry) < 3:
        descriptor = rcl_interfaces.ParameterDescriptor()
    if not isinstance(name, str):
        raise TypeError(f"First element {name} at index {index} in parameters list is not a str.")
    if not isinstance(descriptor, rcl_interfaces.ParameterDescriptor):
        raise TypeError(
            f"Third element {descriptor} at index {index} in parameters list is not a ParameterDescriptor."
        )
    if len(entry) == 1:
        warnings.warn(_NAME_ONLY.format(name), stacklevel=4)
        descriptor.dynamic_typing = True
    if isinstance(second, Parameter.Type):
        descriptor.type = _static_type(name, second, descriptor)
        return Declaration(name, None, descriptor)
    return _with_value(Declaration(name, second, descriptor))


def _static_type(name: str, wanted: Parameter.Type, descriptor: Any) -> int:
    if wanted is Parameter.Type.NOT_SET:
        raise ValueError(f"Cannot declare parameter {{{name}}} as statically typed of type NOT_SET")
    if descriptor.dynamic_typing:
        raise ValueError(
            f"When declaring parameter {{{name}}} passing a descriptor with "
            "`dynamic_typing=True` is not allowed when the parameter type is provided"
        )
    return wanted.value


def _with_value(given: Declaration) -> Declaration:
    name, value, descriptor = given
    if isinstance(value, rcl_interfaces.ParameterValue):
        value = parameter_value_to_python(value)
        if value is None and not descriptor.dynamic_typing:
            raise ValueError(
                "Cannot declare a statically typed parameter with default value of type PARAMETER_NOT_SET"
            )
    if value is not None and not descriptor.dynamic_typing:
        descriptor.type = Parameter.Type.from_parameter_value(value).value
    return Declaration(name, value, descriptor)
