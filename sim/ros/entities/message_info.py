"""The info of a received message."""

import inspect
from collections.abc import Callable
from contextlib import suppress
from typing import Any, TypedDict


class MessageInfo(TypedDict):
    """When a message was sent and received (nanoseconds since 1970), and its two sequence numbers."""

    source_timestamp: int
    received_timestamp: int
    publication_sequence_number: int
    reception_sequence_number: int


def wants_message_info(callback: Callable[..., Any]) -> bool:
    """Whether a subscription's callback takes the message and its info.

    Raises:
        RuntimeError: the callback is not callable with one or two arguments.
        ValueError: it has no signature, as a method without ``self``, or some functions in C.
    """
    for count in (1, 2):
        with suppress(TypeError):
            inspect.signature(callback).bind(*[None] * count)
            return count == 2
    raise RuntimeError(
        "Subscription.__init__(): callback should be either be callable with one argument"
        "(to get only the message) or two (to get message and message info)"
    )
