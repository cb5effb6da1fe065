"""Parameters: named values with one of ten types, and their conversion to messages."""

from __future__ import annotations

import array
from collections.abc import Mapping
from enum import IntEnum
from pathlib import Path
from typing import Any, Generic, TypeAlias, TypeVar

from sim.files import untrusted
from sim.interfaces import rcl_interfaces
from sim.ros.parameters import yaml_files as parameter_yaml
from sim.ros.parameters.yaml_files import ParameterYamlError, PlainValue

PARAMETER_SEPARATOR_STRING = "."

AllowableParameterValue: TypeAlias = (
    "bool | int | float | str | list[bytes] | list[bool] | list[int] | list[float] | list[str] "
    "| tuple[bytes, ...] | tuple[bool, ...] | tuple[int, ...] | tuple[float, ...] | tuple[str, ...] "
    "| array.array[int] | array.array[float] | None"
)
"""The types of a parameter's value."""

AllowableParameterValueT = TypeVar("AllowableParameterValueT")

_SEQUENCES = (list, tuple)
_NUMBER_SEQUENCES = (list, tuple, array.array)


class Parameter(Generic[AllowableParameterValueT]):
    """A parameter's name, type and value; immutable. By default the value determines the type.

    Raises:
        TypeError: ``type_`` is not a ``Parameter.Type``, or no type fits the value.
        ValueError: the value does not have that type.
    """

    class Type(IntEnum):
        """The types of parameters, with the numbers of rcl_interfaces/msg/ParameterType."""

        NOT_SET = 0
        BOOL = 1
        INTEGER = 2
        DOUBLE = 3
        STRING = 4
        BYTE_ARRAY = 5
        BOOL_ARRAY = 6
        INTEGER_ARRAY = 7
        DOUBLE_ARRAY = 8
        STRING_ARRAY = 9

        @classmethod
        def from_parameter_value(cls, parameter_value: object) -> Parameter.Type:
            """The type of a parameter with that value; BYTE_ARRAY for an empty list.

            Raises:
                TypeError: no parameter can have such a value.
            """
            if parameter_value is None:
                return cls.NOT_SET
            for kind, element in _SCALARS.items():
                if isinstance(parameter_value, element):
                    return kind
            if isinstance(parameter_value, _NUMBER_SEQUENCES):
                for kind, element in _ARRAYS.items():
                    if all(isinstance(each, element) for each in parameter_value):
                        return kind
                raise TypeError(
                    f"The given value is not a list of one of the allowed types '{parameter_value}'."
                )
            raise TypeError(f"The given value is not one of the allowed types '{parameter_value}'.")

        def check(self, parameter_value: object) -> bool:
            """Whether a parameter of this type can have that value."""
            if self is Parameter.Type.NOT_SET:
                return parameter_value is None
            if self in _SCALARS:
                return isinstance(parameter_value, _SCALARS[self])
            fits = (
                _NUMBER_SEQUENCES
                if self in (Parameter.Type.INTEGER_ARRAY, Parameter.Type.DOUBLE_ARRAY)
                else _SEQUENCES
            )
            if not isinstance(parameter_value, fits):
                return False
            element = _ARRAYS[self]
            return all(isinstance(each, element) for each in parameter_value) and (
                self is not Parameter.Type.BYTE_ARRAY or all(len(each) == 1 for each in parameter_value)
            )

        def __str__(self) -> str:
            return f"Type.{self.name}"

        def __format__(self, format_spec: str) -> str:
            return format(str(self), format_spec)

    @classmethod
    def from_parameter_msg(cls, param_msg: Any) -> Parameter[Any]:
        """Make a parameter from an rcl_interfaces/msg/Parameter."""
        type_ = Parameter.Type(param_msg.value.type)
        value = None if type_ is Parameter.Type.NOT_SET else getattr(param_msg.value, _field(type_))
        return cls(param_msg.name, type_, value)

    def __init__(
        self, name: str, type_: Parameter.Type | None = None, value: AllowableParameterValueT | None = None
    ) -> None:
        if type_ is None:
            type_ = Parameter.Type.from_parameter_value(value)
        if not isinstance(type_, Parameter.Type):
            raise TypeError(f"type must be an instance of '{Parameter.Type!r}'")
        if not type_.check(value):
            raise ValueError(f"Type '{type_}' and value '{value}' do not agree")
        self._type_ = type_
        self._name = name
        self._value = value

    @property
    def name(self) -> str:
        """The parameter's name."""
        return self._name

    @property
    def type_(self) -> Parameter.Type:
        """The parameter's type."""
        return self._type_

    @property
    def value(self) -> Any:
        """The parameter's value; None if it is not set."""
        return self._value

    def get_parameter_value(self) -> Any:
        """Convert the value to an rcl_interfaces/msg/ParameterValue."""
        message = rcl_interfaces.ParameterValue(type=self._type_.value)
        if self._type_ is not Parameter.Type.NOT_SET:
            # An array.array with another type code than the message's is converted by way of a list.
            value = list(self._value) if isinstance(self._value, array.array) else self._value
            setattr(message, _field(self._type_), value)
        return message

    def to_parameter_msg(self) -> Any:
        """Convert the parameter to an rcl_interfaces/msg/Parameter."""
        return rcl_interfaces.Parameter(name=self._name, value=self.get_parameter_value())


# In the order in which a value's type is searched: True is also an int.
_SCALARS: dict[Parameter.Type, type] = {
    Parameter.Type.BOOL: bool,
    Parameter.Type.INTEGER: int,
    Parameter.Type.DOUBLE: float,
    Parameter.Type.STRING: str,
}
_ARRAYS: dict[Parameter.Type, type] = {
    Parameter.Type.BYTE_ARRAY: bytes,
    Parameter.Type.BOOL_ARRAY: bool,
    Parameter.Type.INTEGER_ARRAY: int,
    Parameter.Type.DOUBLE_ARRAY: float,
    Parameter.Type.STRING_ARRAY: str,
}


def _field(type_: Parameter.Type) -> str:
    """The field of a ParameterValue message for values of that type."""
    return f"{type_.name.lower()}_value"


def parameter_value_to_python(parameter_value: Any) -> Any:
    """The value of an rcl_interfaces/msg/ParameterValue, with arrays as lists; None if it is not set.

    Raises:
        RuntimeError: the message's type is unknown.
    """
    try:
        type_ = Parameter.Type(parameter_value.type)
    except ValueError:
        raise RuntimeError(f"unexpected parameter type {parameter_value.type}") from None
    if type_ is Parameter.Type.NOT_SET:
        return None
    value = getattr(parameter_value, _field(type_))
    return list(value) if type_ in _ARRAYS else value


def get_parameter_value(string_value: str) -> Any:
    """Convert a value in YAML to an rcl_interfaces/msg/ParameterValue; invalid YAML is taken as a text."""
    try:
        plain = parameter_yaml.read_value(string_value)
    except ParameterYamlError:
        plain = string_value
    # An empty list has no type; as on ROS 2's command line, it is a list of truth values.
    parameter = Parameter("", Parameter.Type.BOOL_ARRAY, []) if plain is None else Parameter("", value=plain)
    return parameter.get_parameter_value()


def parameter_dict_from_yaml_file(
    parameter_file: str,
    use_wildcard: bool = False,
    target_nodes: list[str] | None = None,
    namespace: str = "",
) -> dict[str, Any]:
    """Read a parameter file: rcl_interfaces/msg/Parameter messages by name, with ``namespace`` as a prefix.

    The result has the parameters of ``target_nodes`` (none: of all nodes). Those under ``/**`` are used with
    ``use_wildcard``; a node's own parameters override them.

    Raises:
        RuntimeError: a node is not in the file, or no parameters are selected.
        OSError: the file cannot be read.
        ParameterYamlError: it is not a parameter file.
    """
    by_node = parameter_yaml.read_nodes(untrusted.read_text(Path(parameter_file)))
    chosen = ["/**"] if use_wildcard and "/**" in by_node else []
    for node in target_nodes or ():
        if node not in by_node:
            raise RuntimeError(
                f"Param file does not contain parameters for {node},only for nodes: {list(by_node)} "
            )
    chosen += target_nodes or [node for node in by_node if node != "/**"]
    if not chosen:
        raise RuntimeError("Param file does not contain selected parameters")
    values = {name: value for node in chosen for name, value in by_node[node].items()}
    return _as_messages(values, namespace)


def _as_messages(values: Mapping[str, PlainValue], namespace: str) -> dict[str, Any]:
    parameters = (Parameter(namespace + name, value=value) for name, value in values.items())
    return {each.name: each.to_parameter_msg() for each in parameters}
