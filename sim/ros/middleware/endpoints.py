"""Protocols of nodes, publishers, subscriptions and services, as the network uses them.

Call everything with the host's lock held.
"""

from collections.abc import Callable
from typing import Any, Protocol

from sim.ros.middleware.delivery import Request
from sim.ros.qos.qos import QoSProfile


class ContextLifetime(Protocol):
    """A context, as used by code that waits."""

    def ok(self) -> bool:
        """Whether it is initialised and not shut down."""

    def wake_at_end(self, callback: Callable[[], None]) -> None:
        """Call ``callback`` when the context ends."""


class TopicEndpoint(Protocol):
    """A subscription; also what a publisher has in common with it."""

    gid: bytes
    msg_type: type
    qos_profile: QoSProfile

    @property
    def topic_name(self) -> str:
        """The topic's full name."""


class PublisherEndpoint(TopicEndpoint, Protocol):
    """A publisher."""

    def reach(self, subscription: Any) -> None:
        """Start sending to ``subscription``."""

    def reaches(self, subscription: Any) -> bool:
        """Whether it sends to ``subscription``."""

    def forget(self, subscription: Any) -> None:
        """Stop sending to ``subscription``."""

    def catch_up(self, subscription: Any) -> None:
        """Send the kept messages to a late subscription."""

    def type_differs_from(self, subscription: Any) -> None:
        """Report on both sides that the message types differ."""

    def incompatible_with(self, subscription: Any, policy: str) -> None:
        """Report on both sides that a policy is incompatible."""


class ServiceEndpoint(Protocol):
    """A service."""

    name: str
    srv_type: Any

    @property
    def is_shown(self) -> bool:
        """Whether the service belongs to a program that the trace shows."""

    def deliver(self, request: Request) -> None:
        """Queue a request."""


class ClientEndpoint(Protocol):
    """A client."""

    name: str
    srv_type: Any
    gid: bytes

    def overhear(self) -> None:
        """Queue a reply to another client."""


class NetworkNode(Protocol):
    """A node."""

    @property
    def context(self) -> ContextLifetime:
        """The node's context."""

    def destroy_node(self) -> None:
        """Remove the node and its entities."""

    def get_name(self) -> str:
        """The node's name without namespace."""

    def get_fully_qualified_name(self) -> str:
        """The node's namespace and name."""
