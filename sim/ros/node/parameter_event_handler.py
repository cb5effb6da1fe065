"""Callbacks for changes of parameters, of this or another node, from ``/parameter_events``."""

from collections.abc import Callable, Iterable
from contextlib import AbstractContextManager
from dataclasses import dataclass
from itertools import chain
from typing import Any, TypeAlias

from sim.interfaces import rcl_interfaces
from sim.ros.node.node import Node
from sim.ros.qos.qos import QoSProfile, qos_profile_parameter_events

MessageCallback: TypeAlias = Callable[[Any], Any]


@dataclass(eq=False)
class ParameterCallbackHandle:
    """A callback for one parameter of one node."""

    parameter_name: str
    node_name: str
    callback: MessageCallback


@dataclass(eq=False)
class ParameterEventCallbackHandle:
    """A callback for every event."""

    callback: MessageCallback


class ParameterEventHandler:
    """Subscribes a node to ``/parameter_events``, and calls callbacks. Thread-safe.

    The newest callback is called first, and callbacks for one parameter before those for events.
    """

    class Callbacks:
        """The callbacks of a handler. ``lock`` guards them."""

        def __init__(self, lock: AbstractContextManager[bool]) -> None:
            self.event_callbacks: list[ParameterEventCallbackHandle] = []
            self.parameter_callbacks: dict[tuple[str, str], list[ParameterCallbackHandle]] = {}
            self.node_names: frozenset[str] = frozenset()
            self._lock = lock

        def event_callback(self, event: Any) -> None:
            """Call the callbacks for an event; with ``node_names``, events of other nodes are ignored."""
            with self._lock:
                if self.node_names and event.node not in self.node_names:
                    return
                concerned: list[tuple[MessageCallback, Any]] = []
                for (parameter_name, node_name), handles in self.parameter_callbacks.items():
                    parameter = ParameterEventHandler.get_parameter_from_event(
                        event, parameter_name, node_name
                    )
                    if parameter is not None:
                        concerned += [(each.callback, parameter) for each in handles]
                concerned += [(each.callback, event) for each in self.event_callbacks]
            for callback, message in concerned:
                callback(message)

        def add_parameter_event_callback(self, callback: MessageCallback) -> ParameterEventCallbackHandle:
            """Call ``callback`` with every event."""
            handle = ParameterEventCallbackHandle(callback)
            with self._lock:
                self.event_callbacks.insert(0, handle)
            return handle

        def remove_parameter_event_callback(self, handle: ParameterEventCallbackHandle) -> None:
            """Remove a callback; ValueError if it was not added."""
            with self._lock:
                self.event_callbacks.remove(handle)

        def add_parameter_callback(
            self, parameter_name: str, node_name: str, callback: MessageCallback
        ) -> ParameterCallbackHandle:
            """Call ``callback`` with every new value of a parameter."""
            handle = ParameterCallbackHandle(parameter_name, node_name, callback)
            with self._lock:
                self.parameter_callbacks.setdefault((parameter_name, node_name), []).insert(0, handle)
            return handle

        def remove_parameter_callback(self, handle: ParameterCallbackHandle) -> None:
            """Remove a callback; KeyError or ValueError if it was not added."""
            key = (handle.parameter_name, handle.node_name)
            with self._lock:
                self.parameter_callbacks[key].remove(handle)
                if not self.parameter_callbacks[key]:
                    del self.parameter_callbacks[key]

    def __init__(self, node: Node, qos_profile: QoSProfile = qos_profile_parameter_events) -> None:
        self.node = node
        self.qos_profile = qos_profile
        self._callbacks = ParameterEventHandler.Callbacks(node.context.host.lock)
        self._parameter_event_subscription = node.create_subscription(
            rcl_interfaces.ParameterEvent, "/parameter_events", self._callbacks.event_callback, qos_profile
        )

    def destroy(self) -> None:
        """Remove the subscription."""
        self.node.destroy_subscription(self._parameter_event_subscription)

    @staticmethod
    def get_parameter_from_event(event: Any, parameter_name: str, node_name: str) -> Any:
        """The message of a node's parameter that is new or changed in an event, or None."""
        if event.node != node_name:
            return None
        every = ParameterEventHandler.get_parameters_from_event(event)
        return next((each for each in every if each.name == parameter_name), None)

    @staticmethod
    def get_parameters_from_event(event: Any) -> Iterable[Any]:
        """The messages of all parameters that are new or changed in an event."""
        yield from chain(event.new_parameters, event.changed_parameters)

    def configure_nodes_filter(self, node_names: list[str] | None = None) -> bool:
        """Use only the events of these nodes (none: of all nodes); return True."""
        names = frozenset(self._resolve_path(name) for name in node_names or ())
        self._callbacks.node_names = names
        return True

    def add_parameter_event_callback(self, callback: MessageCallback) -> ParameterEventCallbackHandle:
        """Call ``callback`` with every rcl_interfaces/msg/ParameterEvent."""
        return self._callbacks.add_parameter_event_callback(callback)

    def remove_parameter_event_callback(self, callback_handle: ParameterEventCallbackHandle) -> None:
        """Remove a callback; ValueError if it was not added."""
        self._callbacks.remove_parameter_event_callback(callback_handle)

    def add_parameter_callback(
        self, parameter_name: str, node_name: str, callback: MessageCallback
    ) -> ParameterCallbackHandle:
        """Call ``callback`` with the rcl_interfaces/msg/Parameter whenever a node's parameter changes.

        A relative ``node_name`` is in this node's namespace; an empty one means this node.
        """
        return self._callbacks.add_parameter_callback(parameter_name, self._resolve_path(node_name), callback)

    def remove_parameter_callback(self, callback_handle: ParameterCallbackHandle) -> None:
        """Remove a callback; KeyError or ValueError if it was not added."""
        self._callbacks.remove_parameter_callback(callback_handle)

    def _resolve_path(self, node_path: str | None = None) -> str:
        if not node_path:
            return self.node.get_fully_qualified_name()
        if node_path.startswith("/"):
            return node_path
        return f"{self.node.get_namespace().rstrip('/')}/{node_path}"
