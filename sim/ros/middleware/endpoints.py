"""What the network knows of nodes, publishers, subscriptions and services: names, types, and what to call.

All is called with the host's lock held.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

from sim.ros.middleware.delivery import Delivery, Request
from sim.ros.qos.qos import QoSProfile


class Lifetime(Protocol):
    """A context, as far as what waits has to know of it."""

    def ok(self) -> bool:
        """Whether it has begun and not ended."""

    def _wake_at_end(self, callback: Callable[[], None]) -> None:
        """Have ``callback`` run however it ends."""


class EndpointEvents(Protocol):
    """Who hears of the matches of a publisher or subscription."""

    def type_refused(self, warning: str) -> None:
        """There is no match for the type of the messages."""

    def qos_refused(self, policy: str, warning: str) -> None:
        """There is no match for a policy."""


class TopicEnd(Protocol):
    """A publisher or a subscription."""

    gid: bytes
    msg_type: type
    qos_profile: QoSProfile

    @property
    def topic_name(self) -> str:
        """The topic's full name."""

    @property
    def events(self) -> EndpointEvents:
        """Who hears of its matches."""


class SubscriptionEnd(TopicEnd, Protocol):
    """Where messages arrive."""

    def deliver(self, delivery: Delivery) -> None:
        """A message arrived."""

    def found(self, publisher: Any) -> None:
        """A publisher reaches it."""

    def lost(self, publisher: Any) -> None:
        """A publisher that reached it is gone."""


class PublisherEnd(TopicEnd, Protocol):
    """Where messages come from."""

    def reach(self, subscription: Any) -> None:
        """Send to ``subscription`` from now on."""

    def reaches(self, subscription: Any) -> bool:
        """Whether it sends to ``subscription``."""

    def forget(self, subscription: Any) -> None:
        """Send to ``subscription`` no more."""

    def catch_up(self, subscription: Any) -> None:
        """Give a late subscription what was kept for it."""

    def incompatible_with(self, subscription: Any, policy: str) -> None:
        """Both sides tell that they do not match."""


class ServiceEnd(Protocol):
    """Where requests arrive."""

    name: str
    srv_type: Any

    @property
    def is_shown(self) -> bool:
        """Whether it is part of a program that is on the trace."""

    def deliver(self, request: Request) -> None:
        """A request arrived."""


class NetworkNode(Protocol):
    """A node, as the network knows it."""

    @property
    def context(self) -> Lifetime:
        """The context that it lives in."""

    def get_name(self) -> str:
        """Its name without namespace."""
