"""Nodes: what a program builds its publishers, subscriptions, timers, services and clients on."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from types import TracebackType
from typing import TYPE_CHECKING, Any

from sim.ros import rcl_interfaces
from sim.ros.agenda import Agenda
from sim.ros.arguments import arguments_of_node, parameters_for
from sim.ros.callback_groups import (
    CallbackGroup,
    MutuallyExclusiveCallbackGroup,
    ReentrantCallbackGroup,
)
from sim.ros.client import Client
from sim.ros.clock import Clock, ROSClock
from sim.ros.context import Context
from sim.ros.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from sim.ros.guard_condition import GuardCondition
from sim.ros.handle import Handle
from sim.ros.logging import RcutilsLogger, get_logger
from sim.ros.logging_service import LoggingService
from sim.ros.node_graph import GraphQueries
from sim.ros.node_names import NodeNames
from sim.ros.node_parameters import NodeParameters, ParameterChange
from sim.ros.parameter import Parameter
from sim.ros.parameter_events import parameter_event_publisher, publish_change
from sim.ros.parameter_service import ParameterService
from sim.ros.publisher import Publisher
from sim.ros.qos import QoSProfile, as_profile, qos_profile_services_default
from sim.ros.qos_overriding_options import QoSOverridingOptions, overridden
from sim.ros.remapping import Remapping
from sim.ros.rosout import RosoutPublisher, offer_rosout, withdraw_rosout
from sim.ros.service import Service
from sim.ros.subscription import Subscription
from sim.ros.time_source import TimeSource
from sim.ros.timer import Rate, Timer
from sim.ros.type_description_service import TypeDescriptionService
from sim.ros.type_support import check_is_valid_msg_type, check_is_valid_srv_type
from sim.ros.utilities import get_default_context
from sim.ros.waitable import Waitable
from sim.ros.waitable_entity import WaitableEntity
from sim.trace.events import EntityKind

if TYPE_CHECKING:
    from sim.ros.executors import Executor

HIDDEN_NODE_PREFIX = "_"

_MESSAGES_TOO = frozenset(
    (
        "FloatingPointRange",
        "IntegerRange",
        "ListParametersResult",
        "ParameterDescriptor",
        "ParameterEvent",
        "ParameterType",
        "ParameterValue",
        "SetParametersResult",
    )
)
"""Messages that programs also import from here, as rclpy's module uses them."""

if not TYPE_CHECKING:

    def __getattr__(name: str) -> Any:
        if name in _MESSAGES_TOO:
            return getattr(rcl_interfaces, name)
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


class Node(NodeParameters, GraphQueries):
    """A node of the ROS graph.

    ``cli_args`` are arguments for this node alone and count before the program's, which are left out
    without ``use_global_arguments``. ``parameter_overrides`` count before both. Without
    ``enable_rosout`` its log lines do not go to ``/rosout``.

    Raises:
        NotInitializedException: ``rclpy.init()`` has not been called.
        InvalidNodeNameException, InvalidNamespaceException: a name breaks the rules.
        RCLInvalidROSArgsError, UnknownROSArgsError: ``cli_args`` cannot be read.
    """

    def __init__(
        self,
        node_name: str,
        *,
        context: Context | None = None,
        cli_args: Sequence[str] | None = None,
        namespace: str | None = None,
        use_global_arguments: bool = True,
        enable_rosout: bool = True,
        start_parameter_services: bool = True,
        parameter_overrides: list[Parameter[Any]] | None = None,
        allow_undeclared_parameters: bool = False,
        automatically_declare_parameters_from_overrides: bool = False,
        enable_logger_service: bool = False,
    ) -> None:
        self._context = get_default_context() if context is None else context
        self._context.require_ok()
        own_arguments = arguments_of_node(cli_args or ())
        sources = [self._context.arguments, own_arguments] if use_global_arguments else [own_arguments]
        rules = [rule for source in reversed(sources) for rule in source.remap_rules]
        self._node_names = NodeNames(node_name, namespace or "", Remapping(rules))
        given = parameters_for(self.get_fully_qualified_name(), sources)
        overrides = [Parameter(name, value=value) for name, value in given.items()]
        NodeParameters.__init__(
            self, [*overrides, *(parameter_overrides or ())], allow_undeclared=allow_undeclared_parameters
        )
        self._publishers: list[Publisher] = []
        self._rosout_publisher: RosoutPublisher | None = None
        self.destroyed = False
        self._clock = ROSClock()
        self._logger = get_logger(self._node_names.logger_name)
        self._agenda = Agenda(self._context.host, self._context.probe, self._logger)
        self.trace_id = self._context.probe.node_made(self.get_fully_qualified_name())
        self._default_callback_group = MutuallyExclusiveCallbackGroup()
        self._rate_group = ReentrantCallbackGroup()
        with self._agenda.host.lock:
            self._context.network.join_node(self)
        if enable_rosout:
            self._rosout_publisher = offer_rosout(self)
        self._parameter_event_publisher = parameter_event_publisher(self)
        if automatically_declare_parameters_from_overrides:
            self._declare_parameter_overrides()
        self._time_source = TimeSource(node=self)
        self._time_source.attach_clock(self._clock)
        if start_parameter_services:
            self._parameter_service = ParameterService(self)
        if enable_logger_service:
            self._logger_service = LoggingService(self)
        self._type_description_service = TypeDescriptionService(self)

    # What it is

    @property
    def context(self) -> Context:
        """The context it lives in."""
        return self._context

    @property
    def default_callback_group(self) -> CallbackGroup:
        """The mutually exclusive group of all entities that name none."""
        return self._default_callback_group

    @property
    def handle(self) -> Handle:
        """What keeps it alive while it is used."""
        return Handle(self)

    def destroy(self) -> None:
        """Remove everything, as ``destroy_node``."""
        self.destroy_node()

    def get_name(self) -> str:
        """Its name without namespace."""
        return self._node_names.name

    def get_namespace(self) -> str:
        """Its namespace, ``/`` for none."""
        return self._node_names.namespace

    def get_fully_qualified_name(self) -> str:
        """Namespace and name, such as ``/arm/sub_node``."""
        return self._node_names.full_name

    def assert_liveliness(self) -> None:
        """Tell that it lives, which nobody watches."""

    def get_logger(self) -> RcutilsLogger:
        """Its logger."""
        return self._logger

    def get_clock(self) -> Clock:
        """Its clock."""
        return self._clock

    def resolve_topic_name(self, topic: str, *, only_expand: bool = False) -> str:
        """The full name of a topic as this node means it; remapped, unless ``only_expand``.

        Raises:
            InvalidTopicNameException, ValueError: the name breaks the rules, or a substitution is unknown.
            InvalidHandle: the node was destroyed.
        """
        with self.handle:
            return self._node_names.expanded_topic(topic) if only_expand else self._node_names.topic(topic)

    def resolve_service_name(self, service: str, *, only_expand: bool = False) -> str:
        """The full name of a service as this node means it; remapped, unless ``only_expand``.

        Raises:
            InvalidServiceNameException, ValueError: the name breaks the rules, or a substitution is unknown.
            InvalidHandle: the node was destroyed.
        """
        with self.handle:
            names = self._node_names
            return names.expanded_service(service) if only_expand else names.service(service)

    @property
    def executor(self) -> Executor | None:
        """The executor that serves it, if any."""
        return self._agenda.executor

    @executor.setter
    def executor(self, new_executor: Executor | None) -> None:
        current = self.executor
        if current is new_executor:
            return
        self._agenda.executor = None
        if current is not None:
            current.remove_node(self)
        if new_executor is not None:
            self._agenda.executor = new_executor
            new_executor.add_node(self)

    # What it has

    @property
    def publishers(self) -> Iterator[Publisher]:
        """Its publishers."""
        yield from tuple(self._publishers)

    @property
    def subscriptions(self) -> Iterator[Subscription]:
        """Its subscriptions, oldest first."""
        yield from self._agenda.of(Subscription)

    @property
    def timers(self) -> Iterator[Timer]:
        """Its timers, oldest first."""
        yield from self._agenda.of(Timer)

    @property
    def services(self) -> Iterator[Service]:
        """Its services, oldest first."""
        yield from self._agenda.of(Service)

    @property
    def clients(self) -> Iterator[Client]:
        """Its clients, oldest first."""
        yield from self._agenda.of(Client)

    @property
    def guards(self) -> Iterator[GuardCondition]:
        """Its guard conditions, oldest first."""
        yield from self._agenda.of(GuardCondition)

    @property
    def waitables(self) -> Iterator[Any]:
        """Its waitables, oldest first: the program's own, and what tells of events and serves actions."""
        for each in tuple(self._agenda.entities):
            if each.kind is EntityKind.WAITABLE:
                yield each.waitable if isinstance(each, WaitableEntity) else each

    def add_waitable(self, waitable: Waitable[Any]) -> None:
        """Have a waitable served."""
        with self._agenda.host.lock:
            self._agenda.add_asked(WaitableEntity(self, waitable))

    def remove_waitable(self, waitable: Waitable[Any]) -> None:
        """Serve a waitable no more.

        Raises:
            ValueError: it was not added.
        """
        with self._agenda.host.lock:
            for each in self._agenda.asked:
                if each.waitable is waitable:
                    self._agenda.remove_asked(each)
                    return
        raise ValueError("the waitable was not added to this node")

    # Making entities

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
        """Make a publisher; ``qos_profile`` may be a depth.

        Raises:
            InvalidTopicNameException: the topic's name breaks the rules.
            AttributeError, RuntimeError: ``msg_type`` is no message class.
        """
        profile, name = as_profile(qos_profile), self.resolve_topic_name(topic)
        if qos_overriding_options is not None:
            profile = overridden(Publisher, self, name, profile, qos_overriding_options)
        check_is_valid_msg_type(msg_type)
        publisher = publisher_class(
            self, msg_type, topic, profile, event_callbacks=event_callbacks, callback_group=callback_group
        )
        self._publishers.append(publisher)
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
        """Make a subscription; ``qos_profile`` may be a depth.

        The callback takes a message (with ``raw`` its bytes), or a message and its info.

        Raises:
            InvalidTopicNameException: the topic's name breaks the rules.
            AttributeError, RuntimeError: ``msg_type`` is no message class, or the callback takes too much.
        """
        name, profile = self.resolve_topic_name(topic), as_profile(qos_profile)
        if qos_overriding_options is not None:
            profile = overridden(Subscription, self, name, profile, qos_overriding_options)
        check_is_valid_msg_type(msg_type)
        with self._agenda.host.lock:
            group = self._chosen_group(callback_group)
            subscription = Subscription(
                self,
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
        """Make a timer that calls back every ``timer_period_sec`` seconds."""
        period = int(float(timer_period_sec) * 1_000_000_000)
        with self._agenda.host.lock:
            group = self._chosen_group(callback_group)
            timer = Timer(self, period, callback, group, clock or self._clock, autostart=autostart)
            self._agenda.add(timer)
        return timer

    def create_rate(self, frequency: float, clock: Clock | None = None) -> Rate:
        """Make a rate that sleeps ``frequency`` times a second.

        Raises:
            ValueError: the frequency is not above zero.
        """
        if frequency <= 0:
            raise ValueError("frequency must be > 0")
        rate = Rate(self._context)
        rate.timer = self.create_timer(1.0 / frequency, rate.tick, self._rate_group, clock)
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
        """Make a service."""
        check_is_valid_srv_type(srv_type)
        name = self.resolve_service_name(srv_name)
        with self._agenda.host.lock:
            group = self._chosen_group(callback_group)
            service = Service(self, srv_type, name, callback, group, qos_profile, srv_name=srv_name)
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
        """Make a client of a service."""
        check_is_valid_srv_type(srv_type)
        name = self.resolve_service_name(srv_name)
        with self._agenda.host.lock:
            group = self._chosen_group(callback_group)
            self._context.network.want(name)
            client = Client(self, srv_type, name, qos_profile, group, srv_name=srv_name)
            self._agenda.add(client)
        return client

    def create_guard_condition(
        self, callback: Callable[[], Any] | None, callback_group: CallbackGroup | None = None
    ) -> GuardCondition:
        """Make a guard condition."""
        with self._agenda.host.lock:
            guard = GuardCondition(self, callback, self._chosen_group(callback_group))
            self._agenda.add(guard)
        return guard

    def _chosen_group(self, wanted: CallbackGroup | None) -> CallbackGroup:
        return self._default_callback_group if wanted is None else wanted

    # Removing them

    def destroy_publisher(self, publisher: Publisher) -> bool:
        """Remove a publisher; whether it was this node's."""
        if publisher not in self._publishers:
            return False
        self._publishers.remove(publisher)
        publisher.destroy()
        return True

    def destroy_subscription(self, subscription: Subscription) -> bool:
        """Remove a subscription; whether it was this node's."""
        with self._agenda.host.lock:
            if not self._agenda.remove(subscription):
                return False
            self._context.network.leave_subscription(subscription)
            subscription.events.destroy()
        return True

    def destroy_service(self, service: Service) -> bool:
        """Remove a service; whether it was this node's."""
        with self._agenda.host.lock:
            if not self._agenda.remove(service):
                return False
            self._context.network.leave_service(service)
            service.stop_introspection()
        return True

    def destroy_client(self, client: Client) -> bool:
        """Remove a client; whether it was this node's."""
        with self._agenda.host.lock:
            client.stop_introspection()
            return self._agenda.remove(client)

    def destroy_timer(self, timer: Timer) -> bool:
        """Remove a timer; whether it was this node's."""
        return self._agenda.remove(timer)

    def destroy_guard_condition(self, guard: GuardCondition) -> bool:
        """Remove a guard condition; whether it was this node's."""
        return self._agenda.remove(guard)

    def destroy_rate(self, rate: Rate) -> bool:
        """Remove a rate and its timer; whether it was this node's."""
        rate.destroy()
        return rate.timer is not None and self._agenda.remove(rate.timer)

    def destroy_node(self) -> None:
        """Remove everything; the executor that serves the node lets go of it."""
        with self._agenda.host.lock:
            if self.destroyed:
                return
            self.destroyed = True
            self.executor = None
            for publisher in tuple(self._publishers):
                self.destroy_publisher(publisher)
            for entity in tuple(self._agenda.entities):
                entity.destroy()
            withdraw_rosout(self, self._rosout_publisher)
            self._context.network.leave_node(self)

    def _tell_parameter_change(self, change: ParameterChange) -> None:
        publish_change(self._parameter_event_publisher, change)

    def __enter__(self) -> Node:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.destroy_node()

    def __repr__(self) -> str:
        return f"<{type(self).__module__}.{type(self).__qualname__} {self.get_fully_qualified_name()}>"
