"""Messages and requests in transit."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import msgspec


class Delivery(msgspec.Struct, frozen=True):
    """A message in transit, the ``number``-th of its publisher.

    ``shared``: other subscriptions get the same object.
    """

    data: Any
    message: int
    published: int
    shared: bool
    number: int = 0


class ExpiringDelivery(Delivery, frozen=True):
    """A message with a lifespan, which ends at ``expires``."""

    expires: int = 0


class Request(msgspec.Struct, frozen=True):
    """A service request in transit; ``answer`` takes the response.

    ``client`` is the gid of the client: zeros for the person at the console.
    """

    data: Any
    call: int
    sent: int
    answer: Callable[[Any], None]
    client: bytes = bytes(16)
