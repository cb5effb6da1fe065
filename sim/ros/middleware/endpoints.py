"""Protocols of nodes, publishers, subscriptions and services, as the network uses them.

Call everything with the host's lock held.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

from sim.ros.middleware.delivery import Delivery, Request
from sim.ros.qos.qos import QoSProfile


class ContextLifetime(Protocol):
    """A context, as far as waiting code uses it."""

    def ok(self) -> bool:
        """Whether it is initialised and not shut down."""

    def wake_at_end(self, callback: Callable[[], None]) -> None:
        """Call ``callback`` when it ends."""


class MatchListener(Protocol):
    """The listener for matches of a publisher or subscription."""

    def type_refused(self, warning: str) -> None:
        """A match failed because of the message type."""

    def qos_refused(self, policy: str, warning: str) -> None:
        """A match failed because of a policy."""


class TopicEndpoint(Protocol):
    """A publisher or a subscription."""

    gid: bytes
    msg_type: type
    qos_profile: QoSProfile

    @property
    def topic_name(self) -> str:
        """The topic's full name."""

    @property
    def events(self) -> MatchListener:
        """The listener for its matches."""


class SubscriptionEndpoint(TopicEndpoint, Protocol):
    """A subscription."""

    def deliver(self, delivery: Delivery) -> None:
        """Queue a message."""

    def found(self, publisher: Any) -> None:
        """A publisher was matched."""

    def lost(self, publisher: Any) -> None:
        """A matched publisher is gone."""


class PublisherEndpoint(TopicEndpoint, Protocol):
    """A publisher."""

    def reach(self, subscription: Any) -> None:
        """Send to ``subscription`` from now on."""

    def reaches(self, subscription: Any) -> bool:
        """Whether it sends to ``subscription``."""

    def forget(self, subscription: Any) -> None:
        """Send to ``subscription`` no more."""

    def catch_up(self, subscription: Any) -> None:
        """Send a late subscription the kept messages."""

    def of_another_type_than(self, subscription: Any) -> None:
        """Tell that it does not match a subscription because of the message type."""

    def incompatible_with(self, subscription: Any, policy: str) -> None:
        """Report on both sides that they are incompatible."""


class ServiceEndpoint(Protocol):
    """A service."""

    name: str
    srv_type: Any

    @property
    def is_shown(self) -> bool:
        """Whether its program is traced."""

    def deliver(self, request: Request) -> None:
        """Queue a request."""


class NetworkNode(Protocol):
    """A node, as the network knows it."""

    @property
    def context(self) -> ContextLifetime:
        """Its context."""

    def destroy_node(self) -> None:
        """Remove it with all that it has."""

    def get_name(self) -> str:
        """Its name without namespace."""
