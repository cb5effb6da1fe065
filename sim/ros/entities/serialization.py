"""Messages as the bytes that travel between programs (CDR)."""

from __future__ import annotations

from typing import TypeVar

from sim.interfaces import Message, from_cdr, to_cdr
from sim.ros.entities.type_support import check_is_valid_msg_type

MessageT = TypeVar("MessageT", bound=Message)


def serialize_message(message: Message) -> bytes:
    """The bytes of a message: little-endian CDR with its header.

    Raises:
        AttributeError: it is no message.
        NotImplementedError: it contains wide strings.
    """
    check_is_valid_msg_type(type(message))
    return to_cdr(message)


def deserialize_message(serialized_message: bytes, message_type: type[MessageT]) -> MessageT:
    """The message of a type that bytes hold.

    Raises:
        AttributeError, RuntimeError: it is no type of message.
        ValueError: the bytes are no such message.
        NotImplementedError: it contains wide strings.
    """
    check_is_valid_msg_type(message_type)
    return from_cdr(message_type, bytes(serialized_message))
