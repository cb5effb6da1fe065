"""The errors that rclpy raises, under rclpy's names and with its texts."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any


class NotInitializedException(Exception):
    """Something needs ``rclpy.init()`` first."""

    def __init__(self, message: str | None = None) -> None:
        super().__init__(f"rclpy.init() has not been called.{f' msg:{message}' if message else ''}")


class ROSInterruptException(Exception):
    """``rclpy.shutdown()`` ended what was waited for."""

    def __init__(self, *args: object) -> None:
        super().__init__("rclpy.shutdown() has been called", *args)


class InvalidHandle(Exception):
    """An entity was used after it had been destroyed."""


class NameValidationException(Exception):
    """A name breaks ROS 2's rules; tells the rule and points at the place."""

    def __init__(self, name_type: str, name: str, error_msg: str, invalid_index: int) -> None:
        super().__init__(f"Invalid {name_type}: {error_msg}:\n  '{name}'\n   {' ' * invalid_index}^")
        self.name_type = name_type
        self.name = name
        self.error_msg = error_msg
        self.invalid_index = invalid_index


class InvalidNamespaceException(NameValidationException):
    """A namespace breaks the rules."""

    def __init__(self, name: str, error_msg: str, invalid_index: int) -> None:
        super().__init__("namespace", name, error_msg, invalid_index)


class InvalidNodeNameException(NameValidationException):
    """A node's name breaks the rules."""

    def __init__(self, name: str, error_msg: str, invalid_index: int) -> None:
        super().__init__("node name", name, error_msg, invalid_index)


class InvalidTopicNameException(NameValidationException):
    """A topic's name breaks the rules."""

    def __init__(self, name: str, error_msg: str, invalid_index: int) -> None:
        super().__init__("topic name", name, error_msg, invalid_index)


class InvalidServiceNameException(NameValidationException):
    """A service's name breaks the rules."""

    def __init__(self, name: str, error_msg: str, invalid_index: int) -> None:
        super().__init__("service name", name, error_msg, invalid_index)


class RCLError(RuntimeError):
    """ROS's client library refuses something."""


class NodeNameNonExistentError(RCLError):
    """A question about a node that is not there."""


class RCLInvalidROSArgsError(RCLError):
    """An argument after ``--ros-args`` cannot be read."""


class UnknownROSArgsError(RuntimeError):
    """An argument after ``--ros-args`` is none that ROS knows."""


class ParameterException(Exception):
    """Base of what can go wrong with parameters; names the parameters it is about."""

    def __init__(self, error_msg: str, parameters: Sequence[str] | str) -> None:
        super().__init__(f"{error_msg}: {parameters}")


class ParameterNotDeclaredException(ParameterException):
    """A parameter was used before it was declared."""

    def __init__(self, parameters: Sequence[str] | str) -> None:
        super().__init__("Invalid access to undeclared parameter(s)", parameters)


class ParameterAlreadyDeclaredException(ParameterException):
    """A parameter was declared twice."""

    def __init__(self, parameters: Sequence[str] | str) -> None:
        super().__init__("Parameter(s) already declared", parameters)


class InvalidParameterException(ParameterException):
    """A parameter has no usable name."""

    def __init__(self, parameter: str) -> None:
        super().__init__("Invalid parameter name", parameter)


class InvalidParameterTypeException(ParameterException):
    """The value set for a parameter, or overriding it, is of another type than it was declared with."""

    def __init__(self, desired_parameter: Any, expected_type: str) -> None:
        super().__init__(
            f"Trying to set parameter '{desired_parameter.name}' to '{desired_parameter.value}' of type "
            f"'{desired_parameter.type_.name}', expecting type '{expected_type}'",
            desired_parameter.name,
        )


class InvalidParameterValueException(ParameterException):
    """A parameter's descriptor or a callback refused its value."""

    def __init__(self, parameter: str, value: object, reason: str) -> None:
        super().__init__(f"Invalid parameter value ({value}) for parameter. Reason: {reason}", parameter)


class ParameterUninitializedException(ParameterException):
    """A parameter was declared with a type only, and read before it had a value."""

    def __init__(self, parameter_name: str) -> None:
        super().__init__(f"The parameter '{parameter_name}' is not initialized", parameter_name)


class ParameterImmutableException(ParameterException):
    """A read-only parameter was to be changed or removed."""

    def __init__(self, parameter_name: str) -> None:
        super().__init__("Attempted to modify read-only parameter", parameter_name)


for _each in tuple(vars().values()):
    if isinstance(_each, type):
        # A traceback shows it.
        _each.__module__ = "rclpy.exceptions"
