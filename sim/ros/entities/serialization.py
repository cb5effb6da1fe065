"""Encodes messages as CDR, and decodes them."""

from typing import TypeVar

from sim.interfaces import Message, from_cdr, to_cdr
from sim.ros.entities.type_support import check_is_valid_msg_type

MessageT = TypeVar("MessageT", bound=Message)


def serialize_message(message: Message) -> bytes:
    """Encode a message: little-endian CDR with its header.

    Raises:
        AttributeError: it is not a message.
        NotImplementedError: it contains wide strings.
    """
    check_is_valid_msg_type(type(message))
    return to_cdr(message)


def deserialize_message(serialized_message: bytes, message_type: type[MessageT]) -> MessageT:
    """Decode a message of a type.

    Raises:
        AttributeError, RuntimeError: it is not a message type.
        ValueError: the bytes do not encode such a message.
        NotImplementedError: it contains wide strings.
    """
    check_is_valid_msg_type(message_type)
    return from_cdr(message_type, bytes(serialized_message))
