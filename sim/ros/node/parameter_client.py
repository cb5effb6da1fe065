"""Reads and sets the parameters of another node by its services."""

import math
from collections.abc import Callable, Sequence
from typing import Any, TypeAlias

from sim.interfaces import rcl_interfaces
from sim.quantities.nanoseconds import wait_ns
from sim.ros.entities.client import Client
from sim.ros.node.node import Node
from sim.ros.parameters.parameter import Parameter, parameter_dict_from_yaml_file
from sim.ros.qos.qos import QoSProfile, qos_profile_services_default
from sim.ros.scheduling.callback_groups import CallbackGroup
from sim.ros.scheduling.task import Future

FutureCallback: TypeAlias = Callable[[Future[Any]], None]

_POLL = 0.25
"""Seconds between two polls of ``wait_for_services``, as in rclpy."""


class AsyncParameterClient:
    """Accesses another node's parameters. Every method sends one request, and returns its future.

    ``callback``, if given, is called with that future once it is done. The clients belong to
    ``node``, whose executor takes the replies.
    """

    def __init__(
        self,
        node: Node,
        remote_node_name: str,
        qos_profile: QoSProfile = qos_profile_services_default,
        callback_group: CallbackGroup | None = None,
    ) -> None:
        self.remote_node_name = remote_node_name
        self.node = node

        def client(srv_type: Any, name: str) -> Client:
            full = f"{remote_node_name}/{name}"
            return node.create_client(srv_type, full, qos_profile=qos_profile, callback_group=callback_group)

        self._get_parameter_client = client(rcl_interfaces.GetParameters, "get_parameters")
        self._list_parameter_client = client(rcl_interfaces.ListParameters, "list_parameters")
        self._set_parameter_client = client(rcl_interfaces.SetParameters, "set_parameters")
        self._get_parameter_types_client = client(rcl_interfaces.GetParameterTypes, "get_parameter_types")
        self._describe_parameters_client = client(rcl_interfaces.DescribeParameters, "describe_parameters")
        self._set_parameters_atomically_client = client(
            rcl_interfaces.SetParametersAtomically, "set_parameters_atomically"
        )

    def services_are_ready(self) -> bool:
        """Whether the other node offers all six services."""
        return all(
            each.service_is_ready()
            for each in (
                self._list_parameter_client,
                self._set_parameter_client,
                self._get_parameter_client,
                self._get_parameter_types_client,
                self._describe_parameters_client,
                self._set_parameters_atomically_client,
            )
        )

    def wait_for_services(self, timeout_sec: float | None = None) -> bool:
        """Wait until all services are offered; False after ``timeout_sec`` seconds.

        It polls four times a second, and so may return a little after the timeout.
        """
        clock = self.node.context.host.clock
        left = math.inf if timeout_sec is None else timeout_sec
        while not self.services_are_ready() and left > 0.0:
            clock.sleep(wait_ns(_POLL))
            left -= _POLL
        return self.services_are_ready()

    def list_parameters(
        self,
        prefixes: list[str] | None = None,
        depth: int | None = None,
        callback: FutureCallback | None = None,
    ) -> Future[Any]:
        """Request the names with the prefixes (none: all), at most ``depth`` levels deep (0: any)."""
        request = rcl_interfaces.ListParameters.Request(prefixes=prefixes or [], depth=depth or 0)
        return _sent(self._list_parameter_client, request, callback)

    def get_parameters(self, names: list[str], callback: FutureCallback | None = None) -> Future[Any]:
        """Request values; the reply is empty if one of the parameters has no value."""
        request = rcl_interfaces.GetParameters.Request(names=names)
        return _sent(self._get_parameter_client, request, callback)

    def set_parameters(
        self, parameters: Sequence[Parameter[Any] | Any], callback: FutureCallback | None = None
    ) -> Future[Any]:
        """Set parameters one by one; each is a Parameter or an rcl_interfaces/msg/Parameter."""
        request = rcl_interfaces.SetParameters.Request(parameters=_messages(parameters))
        return _sent(self._set_parameter_client, request, callback)

    def describe_parameters(self, names: list[str], callback: FutureCallback | None = None) -> Future[Any]:
        """Request descriptors."""
        request = rcl_interfaces.DescribeParameters.Request(names=names)
        return _sent(self._describe_parameters_client, request, callback)

    def get_parameter_types(self, names: list[str], callback: FutureCallback | None = None) -> Future[Any]:
        """Request types."""
        request = rcl_interfaces.GetParameterTypes.Request(names=names)
        return _sent(self._get_parameter_types_client, request, callback)

    def set_parameters_atomically(
        self, parameters: Sequence[Parameter[Any] | Any], callback: FutureCallback | None = None
    ) -> Future[Any]:
        """Set all of the parameters or none; otherwise as ``set_parameters``."""
        request = rcl_interfaces.SetParametersAtomically.Request(parameters=_messages(parameters))
        return _sent(self._set_parameters_atomically_client, request, callback)

    def delete_parameters(self, names: list[str], callback: FutureCallback | None = None) -> Future[Any]:
        """Remove parameters; the other node refuses this for statically typed ones."""
        return self.set_parameters([Parameter(name) for name in names], callback)

    def load_parameter_file(
        self, parameter_file: str, use_wildcard: bool = False, callback: FutureCallback | None = None
    ) -> Future[Any]:
        """Set every parameter of a YAML file one by one; those under ``/**`` only with ``use_wildcard``.

        Raises:
            RuntimeError, ParameterYamlError: as ``parameter_dict_from_yaml_file``.
        """
        parameters = parameter_dict_from_yaml_file(parameter_file, use_wildcard)
        return self.set_parameters(list(parameters.values()), callback)

    def load_parameter_file_atomically(
        self, parameter_file: str, use_wildcard: bool = False, callback: FutureCallback | None = None
    ) -> Future[Any]:
        """Set all parameters of a YAML file or none; otherwise as ``load_parameter_file``."""
        parameters = parameter_dict_from_yaml_file(parameter_file, use_wildcard)
        return self.set_parameters_atomically(list(parameters.values()), callback)


def _messages(parameters: Sequence[Parameter[Any] | Any]) -> list[Any]:
    return [each.to_parameter_msg() if isinstance(each, Parameter) else each for each in parameters]


def _sent(client: Client, request: Any, callback: FutureCallback | None) -> Future[Any]:
    future = client.call_async(request)
    if callback is not None:
        future.add_done_callback(callback)
    return future
