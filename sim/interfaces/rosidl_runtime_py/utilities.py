"""Interface classes by full name; mirrors ``rosidl_runtime_py.utilities``."""

import importlib
from typing import Any, TypeGuard

from sim.interfaces.base import ActionType, Message, ServiceType
from sim.interfaces.field_types import NamespacedType


def get_namespaced_type(interface_identifier: str) -> NamespacedType:
    """Return the type with the name ``std_msgs/msg/Int32``, which need not be known.

    Raises:
        ValueError: the name does not have three parts, or one of them is empty.
    """
    parts = interface_identifier.split("/")
    if len(parts) != 3:
        raise ValueError(f"Invalid name '{interface_identifier}'. Expected three parts separated by '/'")
    if not all(parts):
        raise ValueError(f"Invalid name '{interface_identifier}'. Must not contain empty parts")
    return NamespacedType(tuple(parts[:-1]), parts[-1])


def import_message_from_namespaced_type(message_type: NamespacedType) -> Any:
    """Return the class of a type; ModuleNotFoundError or AttributeError if there is no such class."""
    return getattr(importlib.import_module(".".join(message_type.namespaces)), message_type.name)


def get_interface(identifier: str) -> Any:
    """Return the class of a message, service or action.

    Raises:
        ValueError: the name has another form.
        ModuleNotFoundError, AttributeError: there is no such interface.
    """
    return import_message_from_namespaced_type(get_namespaced_type(identifier))


def get_message(identifier: str) -> type[Message]:
    """Return a message class; `ValueError` if the interface is not a message."""
    found = get_interface(identifier)
    if not is_message(found):
        raise ValueError(f"Expected '{identifier}' to be a message")
    return found


def get_service(identifier: str) -> ServiceType:
    """Return a service class; `ValueError` if the interface is not a service."""
    found = get_interface(identifier)
    if not is_service(found):
        raise ValueError(f"Expected '{identifier}' to be a service")
    return found


def get_action(identifier: str) -> ActionType:
    """Return an action class; `ValueError` if the interface is not an action."""
    found = get_interface(identifier)
    if not is_action(found):
        raise ValueError(f"Expected '{identifier}' to be an action")
    return found


def is_message(interface: Any) -> TypeGuard[type[Message]]:
    """Whether this is a message class or a message."""
    return isinstance(interface, Message) or (isinstance(interface, type) and issubclass(interface, Message))


def is_service(interface: Any) -> TypeGuard[ServiceType]:
    """Whether this is a service class."""
    return isinstance(interface, ServiceType)


def is_action(interface: Any) -> TypeGuard[ActionType]:
    """Whether this is an action class."""
    return isinstance(interface, ActionType)
