"""Nodes: what a program builds its publishers, subscriptions, timers, services and clients on."""

from __future__ import annotations

from collections.abc import Sequence
from inspect import isfunction
from types import TracebackType
from typing import TYPE_CHECKING, Any

from sim.ros import node_entities, rcl_interfaces
from sim.ros.agenda import Agenda
from sim.ros.arguments import arguments_of_node, parameters_for
from sim.ros.callback_groups import (
    CallbackGroup,
    MutuallyExclusiveCallbackGroup,
    ReentrantCallbackGroup,
)
from sim.ros.clock import Clock, ROSClock
from sim.ros.context import Context
from sim.ros.handle import Handle
from sim.ros.logging import RcutilsLogger, get_logger
from sim.ros.logging_service import LoggingService
from sim.ros.node_entities import NodeEntities
from sim.ros.node_graph import GraphQueries
from sim.ros.node_names import NodeNames
from sim.ros.node_parameters import NodeParameters, ParameterChange
from sim.ros.parameter import Parameter
from sim.ros.parameter_events import parameter_event_publisher, publish_change
from sim.ros.parameter_service import ParameterService
from sim.ros.publisher import Publisher
from sim.ros.remapping import Remapping
from sim.ros.rosout import RosoutPublisher, offer_rosout, withdraw_rosout
from sim.ros.time_source import TimeSource
from sim.ros.tuning import TunedNode
from sim.ros.type_description_service import TypeDescriptionService
from sim.ros.utilities import get_default_context

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
"""Messages that programs also import from here, like the entities, since rclpy's module uses both."""

if not TYPE_CHECKING:

    def __getattr__(name: str) -> Any:
        if name in _MESSAGES_TOO:
            return getattr(rcl_interfaces, name)
        if not name.startswith("_") and hasattr(node_entities, name):
            return getattr(node_entities, name)
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


class Node(NodeEntities, NodeParameters, GraphQueries):
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
        given = parameters_for(self._node_names.full_name, sources)
        overrides = [Parameter(name, value=value) for name, value in given.items()]
        NodeParameters.__init__(
            self, [*overrides, *(parameter_overrides or ())], allow_undeclared=allow_undeclared_parameters
        )
        self._publishers: list[Publisher] = []
        self._rosout_publisher: RosoutPublisher | None = None
        self.destroyed = False
        self._clock = ROSClock()
        self._logger = get_logger(self._node_names.logger_name)
        self._agenda = Agenda(self._context.host, self._context.probe)
        self._tuned = None  # what every node brings along is not the program's
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
        self._tuned = self._tuning()

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
        """Its name without namespace; InvalidHandle once it was destroyed."""
        with self.handle:
            return self._node_names.name

    def get_namespace(self) -> str:
        """Its namespace, ``/`` for none; InvalidHandle once it was destroyed."""
        with self.handle:
            return self._node_names.namespace

    def get_fully_qualified_name(self) -> str:
        """Namespace and name, such as ``/arm/sub_node``; InvalidHandle once it was destroyed."""
        with self.handle:
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
        """The executor that serves it, or that did last: removing a node from one changes nothing here."""
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

    # Its end

    def destroy_node(self) -> None:
        """Remove everything; the executor that serves the node lets go of it."""
        with self._agenda.host.lock:
            if self.destroyed:
                return
            self._tell_of_own_end()
            self.destroyed = True
            self.executor = None
            for publisher in tuple(self._publishers):
                self.destroy_publisher(publisher)
            for entity in tuple(self._agenda.entities):
                entity.destroy()
            withdraw_rosout(self, self._rosout_publisher)
            self._context.network.leave_node(self)

    def _tell_of_own_end(self) -> None:
        """Tell of it if one of the node's own callbacks is what destroys it."""
        probe = self._context.probe
        here = probe.callback_here()
        running = (each for each in self._agenda.entities if each.trace_id == here)
        if here and (entity := next(running, None)) is not None:
            probe.node_destroyed_by_itself(self._node_names.full_name, entity)

    def _tuning(self) -> TunedNode | None:
        """What a person changed about the node; only what is on the screen can be changed there."""
        tuning = self._context.host.tuning
        if tuning is None or not self._context.probe.visible:
            return None
        return TunedNode(self._node_names.full_name, tuning)

    def _tell_parameter_change(self, change: ParameterChange) -> None:
        publish_change(self._parameter_event_publisher, change)

    def __enter__(self) -> Node:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.destroy_node()

    def __repr__(self) -> str:
        return f"<{type(self).__module__}.{type(self).__qualname__} {self._node_names.full_name}>"


# A wrong call is told as one of Node's: programs know no other class of these.
for _part in (NodeEntities, NodeParameters, GraphQueries):
    for _method in vars(_part).values():
        if isfunction(_method):
            _method.__qualname__ = f"{Node.__qualname__}.{_method.__name__}"
