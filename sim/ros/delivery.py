"""Messages on their way from a publisher to the queues of subscriptions."""

from __future__ import annotations

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
