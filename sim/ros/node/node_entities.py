"""Creates, lists and removes a node's entities."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

from sim.probes.on_path.cbtui_probe.naming import callback_name
from sim.ros.clocks.clock import Clock
from sim.ros.context.context import NODE_ENDED
from sim.ros.entities.client import Client
from sim.ros.entities.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from sim.ros.entities.guard_condition import NodeGuardCondition
from sim.ros.entities.publisher import Publisher
from sim.ros.entities.service import Service
from sim.ros.entities.subscription import Subscription
from sim.ros.entities.timer import Rate, Timer
from sim.ros.entities.type_support import check_is_valid_msg_type, check_is_valid_srv_type
from sim.ros.node.node_overrides import NodeOverrides
from sim.ros.node.qos_overriding_options import QoSOverridingOptions, overridden
from sim.ros.qos.qos import QoSProfile, as_profile, qos_profile_services_default
from sim.ros.scheduling.callback_groups import (
    CallbackGroup,
    MutuallyExclusiveCallbackGroup,
    ReentrantCallbackGroup,
)
from sim.ros.scheduling.waitable import Waitable
from sim.ros.scheduling.waitable_entity import WaitableEntity
from sim.trace.events import EntityKind

if TYPE_CHECKING:
    from sim.ros.node.node import Node


class NodeEntities:
    """The entities of a node. Thread-safe, also while the node is spun."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._context = node.context
        self._agenda = node._agenda
        self._publishers: list[Publisher] = []
        self._made_at: Counter[tuple[str, tuple[str, int]]] = Counter()
        self.default_group = MutuallyExclusiveCallbackGroup()
        self._rate_group = ReentrantCallbackGroup()
        self.overrides: NodeOverrides | None = None
        """The run's overrides; None while the node is created, because the node's own entities are not the
        program's."""

    # Listing

    @property
    def publishers(self) -> Iterator[Publisher]:
        """The node's publishers."""
        yield from tuple(self._publishers)

    @property
    def subscriptions(self) -> Iterator[Subscription]:
        """The node's subscriptions, oldest first."""
        yield from self._agenda.of(Subscription)

    @property
    def timers(self) -> Iterator[Timer]:
        """The node's timers, oldest first."""
        yield from self._agenda.of(Timer)

    @property
    def services(self) -> Iterator[Service]:
        """The node's services, oldest first."""
        yield from self._agenda.of(Service)

    @property
    def clients(self) -> Iterator[Client]:
        """The node's clients, oldest first."""
        yield from self._agenda.of(Client)

    @property
    def guards(self) -> Iterator[NodeGuardCondition]:
        """The node's guard conditions, oldest first."""
        yield from self._agenda.of(NodeGuardCondition)

    @property
    def waitables(self) -> Iterator[Any]:
        """The node's waitables, oldest first: the program's own, event handlers, and actions."""
        for each in tuple(self._agenda.entities):
            if each.kind is EntityKind.WAITABLE:
                yield each.waitable if isinstance(each, WaitableEntity) else each

    def add_waitable(self, waitable: Waitable[Any]) -> None:
        """Add a waitable."""
        with self._agenda.host.lock:
            self._agenda.add_polled(WaitableEntity(self._node, waitable))

    def remove_waitable(self, waitable: Waitable[Any]) -> None:
        """Remove a waitable; ValueError if the waitable was not added."""
        with self._agenda.host.lock:
            for each in self._agenda.polled:
                if each.waitable is waitable:
                    self._agenda.remove_polled(each)
                    return
        raise ValueError("the waitable was not added to this node")

    # Creating

    def create_publisher(
        self,
        msg_type: type,
        topic: str,
        qos_profile: QoSProfile | int,
        *,
        callback_group: CallbackGroup | None = None,
        event_callbacks: PublisherEventCallbacks | None = None,
        qos_overriding_options: QoSOverridingOptions | None = None,
        publisher_class: type[Publisher] = Publisher,
    ) -> Publisher:
        """Create a publisher; ``qos_profile`` may be a depth.

        Raises:
            InvalidTopicNameException: the topic's name breaks the rules.
            AttributeError, RuntimeError: ``msg_type`` is not a message class.
        """
        profile, name = as_profile(qos_profile), self._node.resolve_topic_name(topic)
        if qos_overriding_options is not None:
            profile = overridden(Publisher, self._node, name, profile, qos_overriding_options)
        check_is_valid_msg_type(msg_type)
        self._context.require_ok("Failed to create publisher", NODE_ENDED)
        publisher = publisher_class(
            self._node,
            msg_type,
            topic,
            profile,
            event_callbacks=event_callbacks,
            callback_group=callback_group,
        )
        self._publishers.append(publisher)
        alike = publisher.topic_name, publisher.made_at
        self._made_at[alike] += 1
        self._context.probe.usage.publishers_kept(self._made_at[alike], publisher.made_at)
        self._agenda.report_many(len(self._publishers), "publishers")
        return publisher

    def create_subscription(
        self,
        msg_type: type,
        topic: str,
        callback: Callable[..., Any],
        qos_profile: QoSProfile | int,
        *,
        callback_group: CallbackGroup | None = None,
        event_callbacks: SubscriptionEventCallbacks | None = None,
        qos_overriding_options: QoSOverridingOptions | None = None,
        raw: bool = False,
    ) -> Subscription:
        """Create a subscription; ``qos_profile`` may be a depth.

        The callback takes a message (``raw``: its bytes), or a message and its info.

        Raises:
            InvalidTopicNameException: the topic's name breaks the rules.
            AttributeError, RuntimeError: ``msg_type`` is not a message class, or the callback does not fit.
        """
        name, profile = self._node.resolve_topic_name(topic), as_profile(qos_profile)
        if qos_overriding_options is not None:
            profile = overridden(Subscription, self._node, name, profile, qos_overriding_options)
        check_is_valid_msg_type(msg_type)
        self._context.require_ok("Failed to create subscription", NODE_ENDED)
        with self._agenda.host.lock:
            group = self._chosen_group(callback_group, callback_name(callback))
            subscription = Subscription(
                self._node,
                msg_type,
                name,
                callback,
                group,
                profile,
                topic=topic,
                raw=raw,
                event_callbacks=event_callbacks,
            )
            self._agenda.add(subscription)
            self._context.network.join_subscription(subscription)
        return subscription

    def create_timer(
        self,
        timer_period_sec: float,
        callback: Callable[..., Any] | None,
        callback_group: CallbackGroup | None = None,
        clock: Clock | None = None,
        autostart: bool = True,
    ) -> Timer:
        """Create a timer that calls ``callback`` every ``timer_period_sec`` seconds."""
        period = int(float(timer_period_sec) * 1_000_000_000)
        self._context.require_ok("failed to create timer")
        with self._agenda.host.lock:
            name = "" if callback is None else callback_name(callback)
            group = self._chosen_group(callback_group, name)
            if self.overrides is not None:
                period = self.overrides.period(name, period)
            timer = Timer(
                self._node, period, callback, group, clock or self._node.get_clock(), autostart=autostart
            )
            self._agenda.add(timer)
            if not autostart:
                self._node.context.probe.timer_cancelled(timer)
        return timer

    def create_rate(self, frequency: float, clock: Clock | None = None) -> Rate:
        """Create a rate whose sleeps end ``frequency`` times a second.

        Raises:
            ValueError: the frequency is not positive.
        """
        if frequency <= 0:
            raise ValueError("frequency must be > 0")
        period = int(1e9 / frequency)
        self._context.require_ok("failed to create timer")
        with self._agenda.host.lock:
            timer = Timer(self._node, period, None, self._rate_group, clock or self._node.get_clock())
            rate = Rate(timer, context=self._context)
            self._agenda.add(timer)
        return rate

    def create_service(
        self,
        srv_type: Any,
        srv_name: str,
        callback: Callable[[Any, Any], Any],
        *,
        qos_profile: QoSProfile = qos_profile_services_default,
        callback_group: CallbackGroup | None = None,
    ) -> Service:
        """Create a service."""
        check_is_valid_srv_type(srv_type)
        name = self._node.resolve_service_name(srv_name)
        self._context.require_ok("failed to create service", NODE_ENDED)
        with self._agenda.host.lock:
            group = self._chosen_group(callback_group, callback_name(callback))
            service = Service(self._node, srv_type, name, callback, group, qos_profile, srv_name=srv_name)
            self._agenda.add(service)
            self._context.network.join_service(service)
        return service

    def create_client(
        self,
        srv_type: Any,
        srv_name: str,
        *,
        qos_profile: QoSProfile = qos_profile_services_default,
        callback_group: CallbackGroup | None = None,
    ) -> Client:
        """Create a client of a service."""
        check_is_valid_srv_type(srv_type)
        name = self._node.resolve_service_name(srv_name)
        self._context.require_ok("failed to create client", NODE_ENDED)
        with self._agenda.host.lock:
            group = self._chosen_group(callback_group, name)
            self._context.network.announce_use(name)
            client = Client(self._node, srv_type, name, qos_profile, group, srv_name=srv_name)
            self._agenda.add(client)
        return client

    def create_guard_condition(
        self, callback: Callable[[], Any] | None, callback_group: CallbackGroup | None = None
    ) -> NodeGuardCondition:
        """Create a guard condition."""
        self._context.require_ok("failed to create guard_condition")
        with self._agenda.host.lock:
            group = self._chosen_group(callback_group, "" if callback is None else callback_name(callback))
            guard = NodeGuardCondition(self._node, callback, group)
            self._agenda.add(guard)
        return guard

    def _chosen_group(self, wanted: CallbackGroup | None, name: str) -> CallbackGroup:
        """The group of a callback: the program's choice, unless the run overrides it."""
        default = self.default_group
        asked = default if wanted is None else wanted
        return asked if self.overrides is None else self.overrides.group(name, asked, default)

    # Removing

    def destroy_publisher(self, publisher: Publisher) -> bool:
        """Remove a publisher; False if it is not this node's."""
        if publisher not in self._publishers:
            return False
        self._publishers.remove(publisher)
        self._made_at[publisher.topic_name, publisher.made_at] -= 1
        publisher.destroy()
        return True

    def destroy_subscription(self, subscription: Subscription) -> bool:
        """Remove a subscription; False if it is not this node's."""
        return self._agenda.remove(subscription)

    def destroy_service(self, service: Service) -> bool:
        """Remove a service; False if it is not this node's."""
        return self._agenda.remove(service)

    def destroy_client(self, client: Client) -> bool:
        """Remove a client; False if it is not this node's."""
        return self._agenda.remove(client)

    def destroy_timer(self, timer: Timer) -> bool:
        """Remove a timer; False if it is not this node's."""
        return self._agenda.remove(timer)

    def destroy_guard_condition(self, guard: NodeGuardCondition) -> bool:
        """Remove a guard condition; False if it is not this node's."""
        return self._agenda.remove(guard)

    def destroy_rate(self, rate: Rate) -> bool:
        """Remove a rate and its timer; False if it is not this node's."""
        rate.destroy()
        return self._agenda.remove(rate._timer)
