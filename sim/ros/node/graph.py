"""A node's queries of the graph: nodes, topics, services and their endpoints."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable
from itertools import chain
from typing import TYPE_CHECKING, Any, TypeAlias, cast

from sim.interfaces import type_name
from sim.ros.context.context import NODE_ENDED
from sim.ros.entities.publisher import Publisher
from sim.ros.entities.subscription import Subscription
from sim.ros.entities.topic_endpoint_info import TopicEndpointInfo, TopicEndpointTypeEnum
from sim.ros.exceptions import NodeNameNonExistentError
from sim.ros.middleware.network import Network
from sim.ros.middleware.type_description import type_hash
from sim.ros.naming.expand_topic_name import expand_topic_name
from sim.ros.naming.validation import validate_full_topic_name
from sim.ros.qos.offered import as_discovered

if TYPE_CHECKING:
    from sim.ros.node.node import Node

NamesAndTypes: TypeAlias = list[tuple[str, list[str]]]

_POLL = 100_000_000
"""Nanoseconds between two polls of ``wait_for_node``."""


def nodes_on(network: Network) -> tuple[Node, ...]:
    """The nodes of a network whose programs have not ended, oldest first. Call it with the host's lock."""
    # A program that has ended is gone, even if it has not destroyed its nodes.
    return tuple(cast("Node", node) for node in network.nodes() if node.context.ok())


def publishers_of(node: Node) -> tuple[Publisher, ...]:
    """The publishers of a node, including that of ``/rosout``, which ``Node.publishers`` leaves out."""
    rosout = node._rosout_publisher
    return (*(() if rosout is None else (rosout,)), *node.publishers)


class Graph:
    """A node's queries of its whole network.

    Names are expanded for the node, but not remapped. The methods of a destroyed node raise InvalidHandle.
    """

    def __init__(self, node: Node) -> None:
        self._node = node

    # Nodes

    def get_node_names(self) -> list[str]:
        """The names of all nodes, without namespaces."""
        return [node.get_name() for node in self._nodes()]

    def get_node_names_and_namespaces(self) -> list[tuple[str, str]]:
        """Name and namespace of all nodes."""
        return [(node.get_name(), node.get_namespace()) for node in self._nodes()]

    def get_node_names_and_namespaces_with_enclaves(self) -> list[tuple[str, str, str]]:
        """Name, namespace and security enclave (always ``/``) of all nodes."""
        return [(*names, "/") for names in self.get_node_names_and_namespaces()]

    def get_fully_qualified_node_names(self) -> list[str]:
        """The full names of all nodes."""
        return [node.get_fully_qualified_name() for node in self._nodes()]

    def wait_for_node(self, fully_qualified_node_name: str, timeout: float) -> bool:
        """Wait until there is a node of that full name; False after ``timeout`` seconds."""
        clock = self._node.context.host.clock
        end = clock.now() + timeout * 1e9
        wanted = f"/{fully_qualified_node_name.lstrip('/')}"
        while not (found := wanted in self.get_fully_qualified_node_names()) and clock.now() < end:
            clock.sleep(_POLL)
        return found

    # Topics and services

    def get_topic_names_and_types(self, no_demangle: bool = False) -> NamesAndTypes:
        """All topics with their types."""
        ends: list[Publisher | Subscription] = []
        for node in self._nodes():
            ends += (*publishers_of(node), *node.subscriptions)
        return _sorted((each.topic_name, each.msg_type) for each in ends)

    def get_service_names_and_types(self) -> NamesAndTypes:
        """All services with their types."""
        services = chain.from_iterable(node.services for node in self._nodes())
        return _sorted((each.name, each.srv_type) for each in services)

    def get_publisher_names_and_types_by_node(
        self, node_name: str, node_namespace: str, no_demangle: bool = False
    ) -> NamesAndTypes:
        """The topics that a node publishes; NodeNameNonExistentError without that node."""
        node = self._named(node_name, node_namespace, "publisher")
        return _sorted((each.topic_name, each.msg_type) for each in publishers_of(node))

    def get_subscriber_names_and_types_by_node(
        self, node_name: str, node_namespace: str, no_demangle: bool = False
    ) -> NamesAndTypes:
        """The topics that a node subscribes to; NodeNameNonExistentError without that node."""
        node = self._named(node_name, node_namespace, "subscriber")
        return _sorted((each.topic_name, each.msg_type) for each in node.subscriptions)

    def get_service_names_and_types_by_node(self, node_name: str, node_namespace: str) -> NamesAndTypes:
        """The services that a node offers; NodeNameNonExistentError without that node."""
        node = self._named(node_name, node_namespace, "service")
        return _sorted((each.name, each.srv_type) for each in node.services)

    def get_client_names_and_types_by_node(self, node_name: str, node_namespace: str) -> NamesAndTypes:
        """The services that a node calls; NodeNameNonExistentError without that node."""
        node = self._named(node_name, node_namespace, "client")
        return _sorted((each.name, each.srv_type) for each in node.clients)

    # One topic or service

    def count_publishers(self, topic_name: str) -> int:
        """The number of publishers of a topic."""
        full = self._full(topic_name, is_service=False)
        return self._count(lambda node: (each.topic_name == full for each in publishers_of(node)))

    def count_subscribers(self, topic_name: str) -> int:
        """The number of subscriptions of a topic."""
        full = self._full(topic_name, is_service=False)
        return self._count(lambda node: (each.topic_name == full for each in node.subscriptions))

    def count_clients(self, service_name: str) -> int:
        """The number of clients of a service."""
        full = self._full(service_name, is_service=True)
        return self._count(lambda node: (each.name == full for each in node.clients))

    def count_services(self, service_name: str) -> int:
        """The number of servers of a service."""
        full = self._full(service_name, is_service=True)
        return self._count(lambda node: (each.name == full for each in node.services))

    def get_publishers_info_by_topic(
        self, topic_name: str, no_mangle: bool = False
    ) -> list[TopicEndpointInfo]:
        """The publishers of a topic."""
        full = topic_name if no_mangle else self._full(topic_name, is_service=False)
        every = chain.from_iterable(publishers_of(node) for node in self._nodes())
        kind = TopicEndpointTypeEnum.PUBLISHER
        return [_info(each, kind) for each in every if each.topic_name == full]

    def get_subscriptions_info_by_topic(
        self, topic_name: str, no_mangle: bool = False
    ) -> list[TopicEndpointInfo]:
        """The subscriptions of a topic."""
        full = topic_name if no_mangle else self._full(topic_name, is_service=False)
        every = chain.from_iterable(node.subscriptions for node in self._nodes())
        kind = TopicEndpointTypeEnum.SUBSCRIPTION
        return [_info(each, kind) for each in every if each.topic_name == full]

    def _nodes(self) -> tuple[Node, ...]:
        context = self._node.context
        with self._node.handle, context.host.lock:
            context.require_ok("failed to look at the graph", NODE_ENDED)
            return nodes_on(context.network)

    def _named(self, name: str, namespace: str, what: str) -> Node:
        for node in self._nodes():
            if (node.get_name(), node.get_namespace()) == (name, namespace or "/"):
                return node
        raise NodeNameNonExistentError(
            f"Cannot get {what} names and types for nonexistent node: "
            f"node '{name}' in namespace '{namespace}'"
        )

    def _count(self, found: Callable[[Node], Iterable[bool]]) -> int:
        return sum(sum(found(node)) for node in self._nodes())

    def _full(self, name: str, *, is_service: bool) -> str:
        full = expand_topic_name(name, self._node.get_name(), self._node.get_namespace())
        validate_full_topic_name(full, is_service=is_service)
        return full


def _sorted(found: Iterable[tuple[str, Any]]) -> NamesAndTypes:
    types: defaultdict[str, set[str]] = defaultdict(set)
    for name, kind in found:
        types[name].add(type_name(kind))
    return [(name, sorted(types[name])) for name in sorted(types)]


def _info(end: Publisher | Subscription, kind: TopicEndpointTypeEnum) -> TopicEndpointInfo:
    return TopicEndpointInfo(
        node_name=end.node.get_name(),
        node_namespace=end.node.get_namespace(),
        topic_type=type_name(end.msg_type),
        topic_type_hash=type_hash(end.msg_type),
        endpoint_type=kind,
        endpoint_gid=list(end.gid),
        qos_profile=as_discovered(end.qos_profile),
    )
