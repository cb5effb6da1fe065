"""The network: which publishers reach which subscriptions, and which service answers a call.

Delivery takes no time. Everything here is called with the host's lock held.
"""

from collections import defaultdict
from collections.abc import Callable, Iterable, Sequence
from typing import TypeVar

import msgspec

from sim.clock import RunClock
from sim.interfaces import copy_message
from sim.ros.middleware.delivery import Request
from sim.ros.middleware.endpoints import (
    ClientEndpoint,
    NetworkNode,
    PublisherEndpoint,
    ServiceEndpoint,
    TopicEndpoint,
)
from sim.ros.qos.qos import mismatches

ReaderT = TypeVar("ReaderT")


class Network:
    """The nodes, publishers, subscriptions and services of one domain, by full name."""

    def __init__(self, clock: RunClock) -> None:
        self._clock = clock
        self._nodes: list[NetworkNode] = []
        self._publishers: defaultdict[str, list[PublisherEndpoint]] = defaultdict(list)
        self._subscriptions: defaultdict[str, list[TopicEndpoint]] = defaultdict(list)
        self._services: defaultdict[str, list[ServiceEndpoint]] = defaultdict(list)
        self._clients: defaultdict[str, list[ClientEndpoint]] = defaultdict(list)
        self._at_use: dict[str, Callable[[str, bool], None]] = {}

    def at_use(self, names: Iterable[str], action: Callable[[str, bool], None]) -> None:
        """Call ``action`` before each use of such a topic or service, with whether a publisher joins."""
        self._at_use = dict.fromkeys(names, action)

    def announce_use(self, name: str, publishes: bool = False) -> None:
        """Announce that a topic or service is used or looked up, or that a publisher joins."""
        action = self._at_use.get(name)
        if action is not None:
            action(name, publishes)

    def nodes(self) -> tuple[NetworkNode, ...]:
        """The nodes, oldest first."""
        return tuple(self._nodes)

    def join_node(self, node: NetworkNode) -> None:
        """Add a node."""
        self._nodes.append(node)

    def leave_node(self, node: NetworkNode) -> None:
        """Remove a node."""
        self._nodes.remove(node)

    def publishers(self, topic: str) -> tuple[PublisherEndpoint, ...]:
        """The publishers on a topic."""
        self.announce_use(topic)
        return tuple(self._publishers.get(topic, ()))

    def subscriptions(self, topic: str) -> tuple[TopicEndpoint, ...]:
        """The subscriptions to a topic."""
        self.announce_use(topic)
        return tuple(self._subscriptions.get(topic, ()))

    def services(self, srv_type: type) -> tuple[ServiceEndpoint, ...]:
        """The services of a type, in the order in which their names were first used."""
        return tuple(each for them in self._services.values() for each in them if each.srv_type is srv_type)

    def has_service(self, name: str, srv_type: type) -> bool:
        """Whether there is a service of that name and type."""
        return bool(self._servers(name, srv_type))

    def join_publisher(self, publisher: PublisherEndpoint) -> None:
        """Add a publisher, and match it with the subscriptions."""
        self.announce_use(publisher.topic_name, publishes=True)
        self._publishers[publisher.topic_name].append(publisher)
        for subscription in self._in_delivery_order(self._subscriptions.get(publisher.topic_name, ())):
            self._match(publisher, subscription)

    def join_subscription(self, subscription: TopicEndpoint) -> None:
        """Add a subscription, match it, and send it the messages that transient-local publishers kept."""
        self.announce_use(subscription.topic_name)
        self._subscriptions[subscription.topic_name].append(subscription)
        for publisher in self._publishers.get(subscription.topic_name, ()):
            if self._match(publisher, subscription):
                publisher.catch_up(subscription)

    def join_service(self, service: ServiceEndpoint) -> None:
        """Add a service, and order the clients that its replies will reach."""
        self._services[service.name].append(service)
        self._clients[service.name] = self._in_delivery_order(self._clients.get(service.name, ()))

    def join_client(self, client: ClientEndpoint) -> None:
        """Add a client."""
        self._clients[client.name].append(client)

    def leave_publisher(self, publisher: PublisherEndpoint) -> None:
        """Remove a publisher."""
        self._publishers[publisher.topic_name].remove(publisher)

    def leave_subscription(self, subscription: TopicEndpoint) -> None:
        """Remove a subscription from the network and from its publishers."""
        self._subscriptions[subscription.topic_name].remove(subscription)
        for publisher in self._publishers.get(subscription.topic_name, ()):
            publisher.forget(subscription)

    def leave_service(self, service: ServiceEndpoint) -> None:
        """Remove a service."""
        self._services[service.name].remove(service)

    def leave_client(self, client: ClientEndpoint) -> None:
        """Remove a client."""
        self._clients[client.name].remove(client)

    def send_request(self, name: str, srv_type: type, request: Request) -> bool:
        """Deliver a request to every server of the service; False without a server: the request is lost."""
        servers = self._servers(name, srv_type)
        for number, each in enumerate(servers):
            own = copy_message(request.data) if number else request.data
            each.deliver(msgspec.structs.replace(request, data=own))
        return bool(servers)

    def send_reply(self, name: str, srv_type: type, receiver: bytes, deliver: Callable[[], None]) -> None:
        """Deliver a reply to a client of a service, and have the others overhear it."""
        for client in self._clients.get(name, ()):
            if client.gid == receiver:
                deliver()
            elif client.srv_type is srv_type:
                client.overhear()

    def _in_delivery_order(self, readers: Sequence[ReaderT]) -> list[ReaderT]:
        """Readers that were there before their writer, in the order in which each of its messages arrives.

        Fast DDS keeps one of its own for each writer; where threads race, the schedule chooses it.
        """
        rest = list(readers)
        return [rest.pop(self._clock.choose(len(rest))) for _ in readers] if self._clock.races() else rest

    def _servers(self, name: str, srv_type: type) -> list[ServiceEndpoint]:
        self.announce_use(name)
        return [each for each in self._services.get(name, ()) if each.srv_type is srv_type]

    def _match(self, publisher: PublisherEndpoint, subscription: TopicEndpoint) -> bool:
        if publisher.msg_type is not subscription.msg_type:
            publisher.type_differs_from(subscription)
            return False
        problems = list(mismatches(publisher.qos_profile, subscription.qos_profile))
        if problems:
            publisher.incompatible_with(subscription, problems[-1])
            return False
        publisher.reach(subscription)
        return True
