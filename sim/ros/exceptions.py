"""rclpy's exceptions, with its names and messages."""

from collections.abc import Sequence
from typing import Any


class NotInitializedException(Exception):
    """``rclpy.init()`` must be called before."""

    def __init__(self, message: str | None = None) -> None:
        super().__init__(f"rclpy.init() has not been called.{f' msg:{message}' if message else ''}")


class ROSInterruptException(Exception):
    """``rclpy.shutdown()`` ended a wait."""

    def __init__(self, *args: object) -> None:
        super().__init__("rclpy.shutdown() has been called", *args)


class InvalidHandle(Exception):
    """A destroyed entity was used."""


class NameValidationException(Exception):
    """A name breaks ROS 2's rules; the message has the rule and marks the place."""

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
    """An error of ROS's client library."""


class NodeNameNonExistentError(RCLError):
    """A query about a node that does not exist."""


class RCLInvalidROSArgsError(RCLError):
    """An argument after ``--ros-args`` cannot be read."""


class UnknownROSArgsError(RuntimeError):
    """An argument after ``--ros-args`` is unknown."""


class ParameterException(Exception):
    """Base of the errors of parameters; the message names the parameters."""

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
    """A parameter's name is invalid."""

    def __init__(self, parameter: str) -> None:
        super().__init__("Invalid parameter name", parameter)


class InvalidParameterTypeException(ParameterException):
    """The value or override of a parameter has another type than the declaration."""

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
    """A parameter without a value was read."""

    def __init__(self, parameter_name: str) -> None:
        super().__init__(f"The parameter '{parameter_name}' is not initialized", parameter_name)


class ParameterImmutableException(ParameterException):
    """A read-only parameter cannot be changed or removed."""

    def __init__(self, parameter_name: str) -> None:
        super().__init__("Attempted to modify read-only parameter", parameter_name)


for _each in tuple(vars().values()):
    if isinstance(_each, type):
        # The name in tracebacks.
        _each.__module__ = "rclpy.exceptions"
