"""Nodes, which have publishers, subscriptions, timers, services and clients."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from sim.ros.clocks.clock import Clock, ROSClock
from sim.ros.context.arguments import arguments_of_node, parameters_for
from sim.ros.context.context import Context
from sim.ros.context.utilities import get_default_context
from sim.ros.exceptions import NotInitializedException
from sim.ros.handle import Handle
from sim.ros.logging.logger import RcutilsLogger, get_logger
from sim.ros.naming.node_names import NodeNames
from sim.ros.naming.remapping import Remapping
from sim.ros.node.delegation import Delegated
from sim.ros.node.graph import Graph
from sim.ros.node.logging_service import LoggingService
from sim.ros.node.node_entities import NodeEntities
from sim.ros.node.node_overrides import NodeOverrides
from sim.ros.node.parameter_events import parameter_event_publisher, publish_change
from sim.ros.node.parameter_service import ParameterService
from sim.ros.node.rosout import RosoutPublisher, offer_rosout, withdraw_rosout
from sim.ros.node.time_source import TimeSource
from sim.ros.node.type_description_service import TypeDescriptionService
from sim.ros.parameters.checks import PARAM_REL_TOL
from sim.ros.parameters.on_set import OnSetCallbacks
from sim.ros.parameters.parameter import Parameter
from sim.ros.parameters.store import ParameterChange, ParameterStore
from sim.ros.scheduling.agenda import Agenda
from sim.ros.scheduling.callback_groups import CallbackGroup
from sim.ros.scheduling.executors import Executor

HIDDEN_NODE_PREFIX = "_"
_SERVED = ("subscriptions", "timers", "services", "clients", "guards", "waitables")
"""The properties in which rclpy's executors look for what they serve."""
_HIDES = "{0}.{1} hides the {1} of rclpy's nodes: real executors serve what it holds or fail; here all run"


_parameters = Delegated[ParameterStore]("_parameter_store")
_graph = Delegated[Graph]("_graph_queries")
_entities = Delegated[NodeEntities]("_node_entities")


class Node:
    """A node of the ROS graph.

    ``cli_args`` are arguments for this node only and override the program's arguments, which are ignored
    without ``use_global_arguments``. ``parameter_overrides`` override both. Without
    ``enable_rosout`` the log lines are not published on ``/rosout``.

    Raises:
        NotInitializedException: ``rclpy.init()`` was not called.
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
        if not self._context.ok():
            raise NotInitializedException("cannot create node")
        own_arguments = arguments_of_node(cli_args or ())
        sources = [self._context.arguments, own_arguments] if use_global_arguments else [own_arguments]
        rules = [rule for source in reversed(sources) for rule in source.remap_rules]
        self._node_names = NodeNames(node_name, namespace or "", Remapping(rules))
        given = parameters_for(self._node_names.full_name, sources)
        overrides = [Parameter(name, value=value) for name, value in given.items()]
        usage = self._context.probe.usage
        self._parameter_store = ParameterStore(
            [*overrides, *(parameter_overrides or ())],
            self._publish_parameter_change,
            OnSetCallbacks(usage.parameter_overruled, usage.parameters_unanswered),
            usage.refused,
            allow_undeclared=allow_undeclared_parameters,
        )
        self._graph_queries = Graph(self)
        self._rosout_publisher: RosoutPublisher | None = None
        self.destroyed = False
        self._clock = ROSClock()
        self._logger = get_logger(self._node_names.logger_name)
        self._agenda = Agenda(self._context.host, self._context.probe)
        self._node_entities = NodeEntities(self)
        self.trace_id = self._context.probe.node_made(self.get_fully_qualified_name())
        with self._agenda.host.lock:
            self._context.network.join_node(self)
        if enable_rosout:
            self._rosout_publisher = offer_rosout(self)
        self._parameter_event_publisher = parameter_event_publisher(self)
        if automatically_declare_parameters_from_overrides:
            self._parameter_store.declare_overrides()
        self._time_source = TimeSource(node=self)
        self._time_source.attach_clock(self._clock)
        if start_parameter_services:
            self._parameter_service = ParameterService(self)
        if enable_logger_service:
            self._logger_service = LoggingService(self)
        self._type_description_service = TypeDescriptionService(self)
        self._node_entities.overrides = self._callback_overrides()
        for name in _SERVED:
            if getattr(type(self), name) is not getattr(Node, name):
                self._logger.warn(_HIDES.format(type(self).__name__, name))

    __module__ = "rclpy.node"  # printed in tracebacks and reprs

    PARAM_REL_TOL = PARAM_REL_TOL

    # Methods of its parts
    declare_parameter = _parameters(ParameterStore.declare_parameter)
    declare_parameters = _parameters(ParameterStore.declare_parameters)
    undeclare_parameter = _parameters(ParameterStore.undeclare_parameter)
    has_parameter = _parameters(ParameterStore.has_parameter)
    get_parameter = _parameters(ParameterStore.get_parameter)
    get_parameters = _parameters(ParameterStore.get_parameters)
    get_parameter_or = _parameters(ParameterStore.get_parameter_or)
    get_parameters_by_prefix = _parameters(ParameterStore.get_parameters_by_prefix)
    get_parameter_type = _parameters(ParameterStore.get_parameter_type)
    get_parameter_types = _parameters(ParameterStore.get_parameter_types)
    list_parameters = _parameters(ParameterStore.list_parameters)
    set_parameters = _parameters(ParameterStore.set_parameters)
    set_parameters_atomically = _parameters(ParameterStore.set_parameters_atomically)
    add_pre_set_parameters_callback = _parameters(ParameterStore.add_pre_set_parameters_callback)
    add_on_set_parameters_callback = _parameters(ParameterStore.add_on_set_parameters_callback)
    add_post_set_parameters_callback = _parameters(ParameterStore.add_post_set_parameters_callback)
    remove_pre_set_parameters_callback = _parameters(ParameterStore.remove_pre_set_parameters_callback)
    remove_on_set_parameters_callback = _parameters(ParameterStore.remove_on_set_parameters_callback)
    remove_post_set_parameters_callback = _parameters(ParameterStore.remove_post_set_parameters_callback)
    describe_parameter = _parameters(ParameterStore.describe_parameter)
    describe_parameters = _parameters(ParameterStore.describe_parameters)
    set_descriptor = _parameters(ParameterStore.set_descriptor)

    get_node_names = _graph(Graph.get_node_names)
    get_node_names_and_namespaces = _graph(Graph.get_node_names_and_namespaces)
    get_node_names_and_namespaces_with_enclaves = _graph(Graph.get_node_names_and_namespaces_with_enclaves)
    get_fully_qualified_node_names = _graph(Graph.get_fully_qualified_node_names)
    wait_for_node = _graph(Graph.wait_for_node)
    get_topic_names_and_types = _graph(Graph.get_topic_names_and_types)
    get_service_names_and_types = _graph(Graph.get_service_names_and_types)
    get_publisher_names_and_types_by_node = _graph(Graph.get_publisher_names_and_types_by_node)
    get_subscriber_names_and_types_by_node = _graph(Graph.get_subscriber_names_and_types_by_node)
    get_service_names_and_types_by_node = _graph(Graph.get_service_names_and_types_by_node)
    get_client_names_and_types_by_node = _graph(Graph.get_client_names_and_types_by_node)
    count_publishers = _graph(Graph.count_publishers)
    count_subscribers = _graph(Graph.count_subscribers)
    count_clients = _graph(Graph.count_clients)
    count_services = _graph(Graph.count_services)
    get_publishers_info_by_topic = _graph(Graph.get_publishers_info_by_topic)
    get_subscriptions_info_by_topic = _graph(Graph.get_subscriptions_info_by_topic)

    add_waitable = _entities(NodeEntities.add_waitable)
    remove_waitable = _entities(NodeEntities.remove_waitable)
    create_publisher = _entities(NodeEntities.create_publisher)
    create_subscription = _entities(NodeEntities.create_subscription)
    create_timer = _entities(NodeEntities.create_timer)
    create_rate = _entities(NodeEntities.create_rate)
    create_service = _entities(NodeEntities.create_service)
    create_client = _entities(NodeEntities.create_client)
    create_guard_condition = _entities(NodeEntities.create_guard_condition)
    destroy_publisher = _entities(NodeEntities.destroy_publisher)
    destroy_subscription = _entities(NodeEntities.destroy_subscription)
    destroy_service = _entities(NodeEntities.destroy_service)
    destroy_client = _entities(NodeEntities.destroy_client)
    destroy_timer = _entities(NodeEntities.destroy_timer)
    destroy_guard_condition = _entities(NodeEntities.destroy_guard_condition)
    destroy_rate = _entities(NodeEntities.destroy_rate)

    # Entities

    publishers = _entities.view(NodeEntities.publishers)
    subscriptions = _entities.view(NodeEntities.subscriptions)
    timers = _entities.view(NodeEntities.timers)
    services = _entities.view(NodeEntities.services)
    clients = _entities.view(NodeEntities.clients)
    guards = _entities.view(NodeEntities.guards)
    waitables = _entities.view(NodeEntities.waitables)

    # Properties

    @property
    def context(self) -> Context:
        """The node's context."""
        return self._context

    @property
    def default_callback_group(self) -> CallbackGroup:
        """The mutually exclusive group of all entities that are created without a group."""
        return self._node_entities.default_group

    @property
    def handle(self) -> Handle:
        """A handle that keeps the node alive while it is used."""
        return Handle(self)

    @handle.setter
    def handle(self, _value: object) -> None:
        raise AttributeError("handle cannot be modified after node creation")

    def destroy(self) -> None:
        """Destroy the node, as ``destroy_node``."""
        self.destroy_node()

    def get_name(self) -> str:
        """The node's name without namespace; InvalidHandle if the node is destroyed."""
        with self.handle:
            return self._node_names.name

    def get_namespace(self) -> str:
        """The node's namespace, at least ``/``; InvalidHandle if the node is destroyed."""
        with self.handle:
            return self._node_names.namespace

    def get_fully_qualified_name(self) -> str:
        """Namespace and name, such as ``/arm/sub_node``; InvalidHandle if the node is destroyed."""
        with self.handle:
            return self._node_names.full_name

    def assert_liveliness(self) -> None:
        """Do nothing: the liveliness of nodes is not watched."""

    def get_logger(self) -> RcutilsLogger:
        """The node's logger."""
        return self._logger

    def get_clock(self) -> Clock:
        """The node's clock."""
        return self._clock

    def resolve_topic_name(self, topic: str, *, only_expand: bool = False) -> str:
        """The full name of a topic for this node; remapped, unless ``only_expand``.

        Raises:
            InvalidTopicNameException, ValueError: the name breaks the rules, or a substitution is unknown.
            InvalidHandle: the node was destroyed.
        """
        with self.handle:
            return self._node_names.resolve(topic, is_service=False, only_expand=only_expand)

    def resolve_service_name(self, service: str, *, only_expand: bool = False) -> str:
        """The full name of a service for this node; remapped, unless ``only_expand``.

        Raises:
            InvalidServiceNameException, ValueError: the name breaks the rules, or a substitution is unknown.
            InvalidHandle: the node was destroyed.
        """
        with self.handle:
            return self._node_names.resolve(service, is_service=True, only_expand=only_expand)

    @property
    def executor(self) -> Executor | None:
        """The executor that serves the node, or served it last: removing the node does not reset it."""
        return self._agenda.latest_executor

    @executor.setter
    def executor(self, new_executor: Executor | None) -> None:
        current = self.executor
        if current is new_executor:
            return
        self._agenda.forget_executors()
        if current is not None:
            current.remove_node(self)
        if new_executor is not None:
            self._agenda.executor = new_executor
            new_executor.add_node(self)

    # Destruction

    def destroy_node(self) -> None:
        """Remove the node and its entities from the network and from its executor."""
        with self._agenda.host.lock:
            if self.destroyed:
                return
            self._report_own_destruction()
            self.destroyed = True
            self.executor = None
            for publisher in self._node_entities.publishers:
                self.destroy_publisher(publisher)
            for entity in tuple(self._agenda.entities):
                entity.destroy()
            withdraw_rosout(self, self._rosout_publisher)
            self._context.network.leave_node(self)

    def _report_own_destruction(self) -> None:
        """Record it on the trace if one of the node's own callbacks destroys the node."""
        probe = self._context.probe
        here = probe.callback_here()
        running = (each for each in self._agenda.entities if each.trace_id == here)
        if here and (entity := next(running, None)) is not None:
            probe.usage.node_destroyed_by_itself(self._node_names.full_name, entity)

    def _callback_overrides(self) -> NodeOverrides | None:
        """The run's overrides for the node; only a node on the trace can have some."""
        overrides = self._context.host.overrides
        if overrides is None or not self._context.probe.visible:
            return None
        return NodeOverrides(self._node_names.full_name, overrides)

    def _publish_parameter_change(self, change: ParameterChange) -> None:
        publish_change(self._parameter_event_publisher, change)

    def __enter__(self) -> Node:
        self._context.host.profile.require_with_blocks(self)
        return self

    def __exit__(self, *_error: object) -> None:
        self.destroy_node()

    def __repr__(self) -> str:
        return f"<{type(self).__module__}.{type(self).__qualname__} {self._node_names.full_name}>"
