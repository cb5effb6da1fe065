"""The network: which publishers reach which subscriptions, and which service answers a call.

Delivery takes no time. Everything here is called with the host's lock held.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable

from sim.ros.middleware.delivery import Request
from sim.ros.middleware.endpoints import NetworkNode, PublisherEnd, ServiceEnd, SubscriptionEnd
from sim.ros.qos.qos import mismatches


class Network:
    """Every node, publisher, subscription and service of the process, by full name."""

    def __init__(self) -> None:
        self._nodes: list[NetworkNode] = []
        self._publishers: defaultdict[str, list[PublisherEnd]] = defaultdict(list)
        self._subscriptions: defaultdict[str, list[SubscriptionEnd]] = defaultdict(list)
        self._services: defaultdict[str, list[ServiceEnd]] = defaultdict(list)
        self._awaited: dict[str, Callable[[], None]] = {}

    def when_wanted(self, names: Iterable[str], action: Callable[[], None]) -> None:
        """Call ``action`` once, as soon as something wants a topic or service of one of these names."""
        self._awaited = dict.fromkeys(names, action)

    def want(self, name: str) -> None:
        """Something is about to use a topic or service, or asks who offers it."""
        action = self._awaited.get(name)
        if action is not None:
            self._awaited.clear()
            action()

    def nodes(self) -> tuple[NetworkNode, ...]:
        """The nodes, oldest first."""
        return tuple(self._nodes)

    def join_node(self, node: NetworkNode) -> None:
        """A node came up."""
        self._nodes.append(node)

    def leave_node(self, node: NetworkNode) -> None:
        """A node went away."""
        self._nodes.remove(node)

    def publishers(self, topic: str) -> tuple[PublisherEnd, ...]:
        """The publishers on a topic."""
        self.want(topic)
        return tuple(self._publishers.get(topic, ()))

    def subscriptions(self, topic: str) -> tuple[SubscriptionEnd, ...]:
        """The subscriptions to a topic."""
        self.want(topic)
        return tuple(self._subscriptions.get(topic, ()))

    def services(self, srv_type: type) -> tuple[ServiceEnd, ...]:
        """The services of a type, in the order in which their names came up."""
        return tuple(each for them in self._services.values() for each in them if each.srv_type is srv_type)

    def has_service(self, name: str, srv_type: type) -> bool:
        """Whether somebody offers a service of that name and type."""
        return self._server(name, srv_type) is not None

    def join_publisher(self, publisher: PublisherEnd) -> None:
        """A publisher came up: it is matched with every subscription that can hear it."""
        self.want(publisher.topic_name)
        self._publishers[publisher.topic_name].append(publisher)
        for subscription in self._subscriptions.get(publisher.topic_name, ()):
            self._match(publisher, subscription)

    def join_subscription(self, subscription: SubscriptionEnd) -> None:
        """A subscription came up: matched, and given what transient-local publishers have kept."""
        self.want(subscription.topic_name)
        self._subscriptions[subscription.topic_name].append(subscription)
        for publisher in self._publishers.get(subscription.topic_name, ()):
            if self._match(publisher, subscription):
                publisher.catch_up(subscription)

    def join_service(self, service: ServiceEnd) -> None:
        """A service came up."""
        self._services[service.name].append(service)

    def leave_publisher(self, publisher: PublisherEnd) -> None:
        """A publisher went away."""
        self._publishers[publisher.topic_name].remove(publisher)

    def leave_subscription(self, subscription: SubscriptionEnd) -> None:
        """A subscription went away; nobody sends to it any more."""
        self._subscriptions[subscription.topic_name].remove(subscription)
        for publisher in self._publishers.get(subscription.topic_name, ()):
            publisher.forget(subscription)

    def leave_service(self, service: ServiceEnd) -> None:
        """A service went away."""
        self._services[service.name].remove(service)

    def send_request(self, name: str, srv_type: type, request: Request) -> bool:
        """Take a request to the service; without one it is lost (False)."""
        server = self._server(name, srv_type)
        if server is None:
            return False
        server.deliver(request)
        return True

    def _server(self, name: str, srv_type: type) -> ServiceEnd | None:
        self.want(name)
        return next((each for each in self._services.get(name, ()) if each.srv_type is srv_type), None)

    def _match(self, publisher: PublisherEnd, subscription: SubscriptionEnd) -> bool:
        if publisher.msg_type is not subscription.msg_type:
            refused = f"Incompatible type on topic '{publisher.topic_name}', no messages will be"
            publisher.events.type_refused(f"{refused} sent to it.")
            subscription.events.type_refused(f"{refused} received from it.")
            return False
        problems = list(mismatches(publisher.qos_profile, subscription.qos_profile))
        if problems:
            publisher.incompatible_with(subscription, problems[-1])
            return False
        publisher.reach(subscription)
        return True
