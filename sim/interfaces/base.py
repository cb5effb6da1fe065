"""The base classes of all message, service and action classes."""

from __future__ import annotations

from array import array
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, NoReturn, TypeVar, cast

import numpy as np
from attrs import frozen

from sim.interfaces.field_types import FieldType, NamespacedType
from sim.interfaces.interface_definition import Definition
from sim.interfaces.sequences import FieldRules


@frozen(eq=False)
class Interface:
    """The definition, types and behaviour of a message class."""

    definition: Definition
    types: Mapping[str, FieldType]
    """The type of every field, in the order of definition."""
    parts: Mapping[NamespacedType, type[Message]]
    """The classes of the messages that its fields contain."""
    field_rules: Mapping[str, FieldRules]
    """How each field checks, makes and copies its value."""
    fixed_names: frozenset[str]
    """The names of the class attributes for constants and declared default values."""
    copy: Callable[[Any], Any]
    """Returns a message as a subscriber receives it."""


class MessageType(type):
    """The metaclass of messages; constants and default values cannot be set."""

    if TYPE_CHECKING:
        # Constants are made at run time from definitions.
        def __getattr__(cls, name: str) -> Any: ...

    def __setattr__(cls, name: str, value: object) -> None:
        # Only these names are in capitals. A class under construction has no __interface__ yet.
        if name.isupper() and name in cls.__interface__.fixed_names:
            raise AttributeError(f"property {name!r} of 'Metaclass_{cls.__name__}' object has no setter")
        super().__setattr__(name, value)


class Message(metaclass=MessageType):
    """A ROS 2 message, or the request or response of a service.

    `message` and `service` return its subclasses. As in rclpy, the constructor takes field values
    by keyword, every field has a default, values are stored in slots ``_<field>`` behind
    properties of the fields' names, and every assignment is checked. ``check_fields=True``, an argument
    of rosidl's newer classes, is accepted too.

    Raises:
        AssertionError: on construction or assignment, if a value does not fit the field or the
            field does not exist; the text is that of rosidl's generated code.
        NotImplementedError: construction with ``check_fields=False``.
        AttributeError: assignment to an attribute that is not a field.
    """

    __slots__: tuple[str, ...] = ()
    __interface__: ClassVar[Interface]
    __type_name__: ClassVar[str]
    SLOT_TYPES: ClassVar[tuple[FieldType, ...]] = ()
    """The type of every field, in the order of definition."""
    _fields_and_field_types: ClassVar[dict[str, str]] = {}
    """The result of ``get_fields_and_field_types``; code written for rosidl's classes reads it, too."""
    _check_fields: ClassVar[bool] = True

    if TYPE_CHECKING:
        # Fields are made at run time from definitions.
        def __init__(self, **values: Any) -> None: ...
        def __getattr__(self, name: str) -> Any: ...
        def __setattr__(self, name: str, value: Any) -> None: ...

    @classmethod
    def get_fields_and_field_types(cls) -> dict[str, str]:
        """Return the type of every field as text: ``{"ranges": "sequence<float>", …}``."""
        return dict(cls._fields_and_field_types)

    def __repr__(self) -> str:
        package = type(self).__module__.rpartition(".")[0]
        values = [f"{name}={_shown(getattr(self, name))}" for name in self.__interface__.types]
        return f"{package}.{type(self).__name__}({', '.join(values)})"

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, type(self)):
            return False
        # Not compared as tuples: a tuple counts a NaN as equal to itself.
        return all(_same(getattr(self, name), getattr(other, name)) for name in self.__interface__.types)

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[Callable[..., Message], tuple[object, ...]]:
        values = {name: getattr(self, name) for name in self.__interface__.types}
        return _restored, (self.__type_name__, values)


MessageT = TypeVar("MessageT", bound=Message)


class ServiceType(type):
    """The metaclass of services such as ``std_srvs.srv.SetBool``, which are never instantiated."""

    Request: type[Message]
    Response: type[Message]
    __type_name__: str

    @property
    def Event(cls) -> type[Message]:
        """The message that reports one step of a call."""
        return _message_class(f"{cls.__type_name__}_Event")

    def __call__(cls, *args: object, **values: object) -> NoReturn:
        """Raise `NotImplementedError`, as rosidl's service classes do."""
        raise NotImplementedError("Service classes can not be instantiated")


class ActionType(type):
    """The metaclass of actions such as ``example_interfaces.action.Fibonacci``, never instantiated."""

    Goal: type[Message]
    Result: type[Message]
    Feedback: type[Message]
    Impl: type[ActionImpl]
    __type_name__: str

    def __call__(cls, *args: object, **values: object) -> NoReturn:
        """Raise `NotImplementedError`, as rosidl's action classes do."""
        raise NotImplementedError("Action classes can not be instantiated")


class ActionImpl:
    """The services and messages that carry an action's goals, results and feedback."""

    SendGoalService: ClassVar[ServiceType]
    GetResultService: ClassVar[ServiceType]
    FeedbackMessage: ClassVar[type[Message]]
    CancelGoalService: ClassVar[ServiceType]
    """``action_msgs/srv/CancelGoal`` for every action."""
    GoalStatusMessage: ClassVar[type[Message]]
    """``action_msgs/msg/GoalStatusArray`` for every action."""


def copy_message(message: MessageT) -> MessageT:
    """Return a copy that shares nothing with the message, as a subscriber receives it.

    Values change as in a transport: 32-bit floats lose the digits that they cannot hold,
    subclasses of Python's numbers become plain numbers, and tuples and sets in a field become lists.
    """
    return cast("MessageT", message.__interface__.copy(message))


def assemble(cls: type[MessageT], values: Mapping[str, Any]) -> MessageT:
    """Return a message with a value for every field; the values are stored unchecked."""
    message = cls.__new__(cls)
    for name, value in values.items():
        setattr(message, f"_{name}", value)
    return message


_message_class: Callable[[str], type[Message]]


def look_up_by(message_class: Callable[[str], type[Message]]) -> None:
    """Make ``message_class`` the function that pickles and services use to get a class by its full name."""
    global _message_class  # noqa: PLW0603 -- the registry of all classes imports this module
    _message_class = message_class


def _restored(type_name: str, values: Mapping[str, Any]) -> Message:
    """Return the message that a pickle or a copy describes."""
    return assemble(_message_class(type_name), values)


def type_name(cls: type[Message] | ServiceType | ActionType) -> str:
    """Return the full name of a class: ``std_msgs/msg/Int32``, ``std_srvs/srv/SetBool``."""
    return cls.__type_name__


def _shown(value: Any) -> str:
    """Return the text of a field's value; an ``array.array`` is shown as a list."""
    return repr(value.tolist()) if isinstance(value, array) else repr(value)


def _same(one: Any, other: Any) -> bool:
    if isinstance(one, np.ndarray):
        return bool(np.array_equal(one, other))
    return bool(one == other)
