"""Messages and requests in transit."""

from collections.abc import Callable
from typing import Any

import msgspec


class Delivery(msgspec.Struct, frozen=True):
    """A message in transit, with the ``number`` that its publisher gave it.

    ``message`` is its id on the trace, ``published`` its time in nanoseconds. ``shared``: other
    subscriptions get the same object.
    """

    data: Any
    message: int
    published: int
    shared: bool
    number: int = 0


class ExpiringDelivery(Delivery, frozen=True):
    """A message with a lifespan, which ends at ``expires`` nanoseconds."""

    expires: int = 0


class Request(msgspec.Struct, frozen=True):
    """A service request in transit; ``answer`` delivers the response.

    ``client`` is the gid of the client: zeros for a call from the console.
    """

    data: Any
    call: int
    sent: int
    answer: Callable[[Any], None]
    client: bytes = bytes(16)
