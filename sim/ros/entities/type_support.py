"""Checks that a class is a ROS 2 message or service type."""

from typing import Any, TypeVar

from sim.interfaces import Message, ServiceType

Msg = Message
Srv = ServiceType
MsgT = TypeVar("MsgT", bound=Message)
SrvT = TypeVar("SrvT", bound=ServiceType)
SrvRequestT = TypeVar("SrvRequestT", bound=Message)
SrvResponseT = TypeVar("SrvResponseT", bound=Message)
SrvEventT = TypeVar("SrvEventT", bound=Message)


class NoTypeSupportImportedException(Exception):
    """The type support of a foreign type cannot be loaded; the model's types need none."""

    __module__ = "rclpy.type_support"


def check_for_type_support(msg_or_srv_type: Any) -> None:
    """Check that an object is an interface class.

    Raises:
        AttributeError: it is not an interface class.
        NoTypeSupportImportedException: a foreign interface class cannot load its type support.
    """
    if isinstance(msg_or_srv_type, Message | ServiceType) or _is_message(msg_or_srv_type):
        return
    kind = type(msg_or_srv_type)
    if not hasattr(kind, "_TYPE_SUPPORT"):
        raise AttributeError(
            f"type object '{kind.__name__}' has no attribute '_TYPE_SUPPORT' "
            "This might be a ROS 1 message type but it should be a ROS 2 message type. "
            "Make sure to source your ROS 2 workspace after your ROS 1 workspace."
        )
    if kind._TYPE_SUPPORT is None:
        kind.__import_type_support__()
    if kind._TYPE_SUPPORT is None:
        raise NoTypeSupportImportedException


def check_is_valid_msg_type(msg_type: Any) -> None:
    """Check that an object is a message class, or a message, which rclpy takes for its class.

    Raises:
        AttributeError: it is not an interface class.
        RuntimeError: it is a service class.
    """
    check_for_type_support(msg_type)
    if not _is_message(message_class(msg_type)):
        raise RuntimeError(
            f"The message type provided is not valid ({msg_type}), this might be a service or action"
        )


def message_class(msg_type: Any) -> Any:
    """The class of what ``create_publisher`` or ``create_subscription`` was given: a class, or a message."""
    return type(msg_type) if isinstance(msg_type, Message) else msg_type


def check_is_valid_srv_type(srv_type: Any) -> None:
    """Check that an object is a service class.

    Raises:
        AttributeError: it is not an interface class.
        RuntimeError: it is a message class.
    """
    check_for_type_support(srv_type)
    if _is_message(srv_type):
        raise RuntimeError(
            f"The service type provided is not valid ({srv_type}), this might be a message or action"
        )


def _is_message(kind: Any) -> bool:
    return isinstance(kind, type) and issubclass(kind, Message)
