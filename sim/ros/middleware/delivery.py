"""Messages and requests on their way."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import msgspec


class Delivery(msgspec.Struct, frozen=True):
    """A message on its way, the ``number``-th of its publisher.

    ``shared`` tells that other subscriptions get the same object.
    """

    data: Any
    message: int
    published: int
    shared: bool
    number: int = 0


class ExpiringDelivery(Delivery, frozen=True):
    """A message that nobody gets any more from the moment ``expires`` on."""

    expires: int = 0


class Request(msgspec.Struct, frozen=True):
    """A service request on its way; ``answer`` takes the response to whoever asked.

    ``client`` is the gid of the client that asked: zeros for the person at the console.
    """

    data: Any
    call: int
    sent: int
    answer: Callable[[Any], None]
    client: bytes = bytes(16)
