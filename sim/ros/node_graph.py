"""What a node can ask about the graph: who is there, and who speaks of what under which name."""

from __future__ import annotations

from abc import abstractmethod
from collections import defaultdict
from collections.abc import Callable, Iterable
from itertools import chain
from typing import TYPE_CHECKING, Any, TypeAlias

from sim.ros.agenda import Agenda
from sim.ros.exceptions import NodeNameNonExistentError
from sim.ros.expand_topic_name import expand_topic_name
from sim.ros.handle import Handle
from sim.ros.interfaces import type_name
from sim.ros.offered_qos import as_discovered
from sim.ros.topic_endpoint_info import TopicEndpointInfo, TopicEndpointTypeEnum
from sim.ros.type_description import type_hash
from sim.ros.validate_full_topic_name import validate_full_topic_name

if TYPE_CHECKING:
    from sim.ros.context import Context
    from sim.ros.node import Node
    from sim.ros.publisher import Publisher
    from sim.ros.subscription import Subscription

NamesAndTypes: TypeAlias = list[tuple[str, list[str]]]

_POLL = 100_000_000
"""Nanoseconds between two looks of ``wait_for_node``."""


def publishers_of(node: Node) -> tuple[Publisher, ...]:
    """The publishers of a node, among them the one for ``/rosout``, which its ``publishers`` do not name."""
    rosout = node._rosout_publisher
    return (*(() if rosout is None else (rosout,)), *node.publishers)


class GraphQueries:
    """The questions about the graph; a node answers them for its whole network.

    Names are expanded as the node means them, and not remapped. A destroyed node answers with InvalidHandle.
    """

    _agenda: Agenda

    @property
    @abstractmethod
    def context(self) -> Context:
        """The node's context."""

    @property
    @abstractmethod
    def handle(self) -> Handle:
        """The node's handle."""

    @abstractmethod
    def get_name(self) -> str:
        """The node's name."""

    @abstractmethod
    def get_namespace(self) -> str:
        """The node's namespace."""

    # Nodes

    def get_node_names(self) -> list[str]:
        """The names of all nodes, without namespaces."""
        return [node.get_name() for node in self.__nodes()]

    def get_node_names_and_namespaces(self) -> list[tuple[str, str]]:
        """Name and namespace of all nodes."""
        return [(node.get_name(), node.get_namespace()) for node in self.__nodes()]

    def get_node_names_and_namespaces_with_enclaves(self) -> list[tuple[str, str, str]]:
        """Name, namespace and security enclave (always ``/``) of all nodes."""
        return [(*names, "/") for names in self.get_node_names_and_namespaces()]

    def get_fully_qualified_node_names(self) -> list[str]:
        """The full names of all nodes."""
        return [node.get_fully_qualified_name() for node in self.__nodes()]

    def wait_for_node(self, fully_qualified_node_name: str, timeout: float) -> bool:
        """Wait until there is a node of that full name; False when ``timeout`` seconds were not enough."""
        clock = self._agenda.host.clock
        end = clock.now() + timeout * 1e9
        wanted = f"/{fully_qualified_node_name.lstrip('/')}"
        while not (found := wanted in self.get_fully_qualified_node_names()) and clock.now() < end:
            clock.sleep(_POLL)
        return found

    # Topics and services

    def get_topic_names_and_types(self, no_demangle: bool = False) -> NamesAndTypes:
        """All topics with their types."""
        ends: list[Publisher | Subscription] = []
        for node in self.__nodes():
            ends += (*publishers_of(node), *node.subscriptions)
        return _sorted((each.topic_name, each.msg_type) for each in ends)

    def get_service_names_and_types(self) -> NamesAndTypes:
        """All services with their types."""
        services = chain.from_iterable(node.services for node in self.__nodes())
        return _sorted((each.name, each.srv_type) for each in services)

    def get_publisher_names_and_types_by_node(
        self, node_name: str, node_namespace: str, no_demangle: bool = False
    ) -> NamesAndTypes:
        """The topics that a node publishes; raises NodeNameNonExistentError without that node."""
        node = self.__node(node_name, node_namespace, "publisher")
        return _sorted((each.topic_name, each.msg_type) for each in publishers_of(node))

    def get_subscriber_names_and_types_by_node(
        self, node_name: str, node_namespace: str, no_demangle: bool = False
    ) -> NamesAndTypes:
        """The topics that a node subscribes to; raises NodeNameNonExistentError without that node."""
        node = self.__node(node_name, node_namespace, "subscriber")
        return _sorted((each.topic_name, each.msg_type) for each in node.subscriptions)

    def get_service_names_and_types_by_node(self, node_name: str, node_namespace: str) -> NamesAndTypes:
        """The services that a node offers; raises NodeNameNonExistentError without that node."""
        node = self.__node(node_name, node_namespace, "service")
        return _sorted((each.name, each.srv_type) for each in node.services)

    def get_client_names_and_types_by_node(self, node_name: str, node_namespace: str) -> NamesAndTypes:
        """The services that a node calls; raises NodeNameNonExistentError without that node."""
        node = self.__node(node_name, node_namespace, "client")
        return _sorted((each.name, each.srv_type) for each in node.clients)

    # One topic or service

    def count_publishers(self, topic_name: str) -> int:
        """How many publishers a topic has."""
        full = self.__full(topic_name, is_service=False)
        return self.__count(lambda node: (each.topic_name == full for each in publishers_of(node)))

    def count_subscribers(self, topic_name: str) -> int:
        """How many subscriptions a topic has."""
        full = self.__full(topic_name, is_service=False)
        return self.__count(lambda node: (each.topic_name == full for each in node.subscriptions))

    def count_clients(self, service_name: str) -> int:
        """How many clients a service has."""
        full = self.__full(service_name, is_service=True)
        return self.__count(lambda node: (each.name == full for each in node.clients))

    def count_services(self, service_name: str) -> int:
        """How many offer a service."""
        full = self.__full(service_name, is_service=True)
        return self.__count(lambda node: (each.name == full for each in node.services))

    def get_publishers_info_by_topic(
        self, topic_name: str, no_mangle: bool = False
    ) -> list[TopicEndpointInfo]:
        """The publishers of a topic."""
        full = topic_name if no_mangle else self.__full(topic_name, is_service=False)
        every = chain.from_iterable(publishers_of(node) for node in self.__nodes())
        kind = TopicEndpointTypeEnum.PUBLISHER
        return [_info(each, kind) for each in every if each.topic_name == full]

    def get_subscriptions_info_by_topic(
        self, topic_name: str, no_mangle: bool = False
    ) -> list[TopicEndpointInfo]:
        """The subscriptions of a topic."""
        full = topic_name if no_mangle else self.__full(topic_name, is_service=False)
        every = chain.from_iterable(node.subscriptions for node in self.__nodes())
        kind = TopicEndpointTypeEnum.SUBSCRIPTION
        return [_info(each, kind) for each in every if each.topic_name == full]

    def __nodes(self) -> tuple[Node, ...]:
        with self.handle, self._agenda.host.lock:
            # A program that has ended is gone, also if it left its nodes undestroyed.
            return tuple(node for node in self.context.network.nodes() if node.context.ok())

    def __node(self, name: str, namespace: str, what: str) -> Node:
        for node in self.__nodes():
            if (node.get_name(), node.get_namespace()) == (name, namespace or "/"):
                return node
        raise NodeNameNonExistentError(
            f"Cannot get {what} names and types for nonexistent node: "
            f"node '{name}' in namespace '{namespace}'"
        )

    def __count(self, found: Callable[[Node], Iterable[bool]]) -> int:
        return sum(sum(found(node)) for node in self.__nodes())

    def __full(self, name: str, *, is_service: bool) -> str:
        full = expand_topic_name(name, self.get_name(), self.get_namespace())
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
