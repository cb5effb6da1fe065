"""The six services with which other nodes read and set a node's parameters."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sim.interfaces import rcl_interfaces
from sim.ros.entities.hidden_service import offer_hidden
from sim.ros.exceptions import ParameterNotDeclaredException, ParameterUninitializedException
from sim.ros.parameters.parameter import Parameter
from sim.ros.qos.qos import qos_profile_parameters

if TYPE_CHECKING:
    from sim.ros.node.node import Node


class ParameterService:
    """Offers the six services, in the node's default group.

    As in rclpy, a response is empty if one of the names is unknown or has no value.
    """

    def __init__(self, node: Node) -> None:
        self._node = node
        for srv_type, name, callback in (
            (rcl_interfaces.DescribeParameters, "describe_parameters", self._describe),
            (rcl_interfaces.GetParameters, "get_parameters", self._get),
            (rcl_interfaces.GetParameterTypes, "get_parameter_types", self._get_types),
            (rcl_interfaces.ListParameters, "list_parameters", self._list),
            (rcl_interfaces.SetParameters, "set_parameters", self._set),
            (rcl_interfaces.SetParametersAtomically, "set_parameters_atomically", self._set_atomically),
        ):
            offer_hidden(node, srv_type, f"~/{name}", callback, qos_profile_parameters)

    def _describe(self, request: Any, response: Any) -> Any:
        try:
            response.descriptors = self._node.describe_parameters(list(request.names))
        except ParameterNotDeclaredException as error:
            self._node.get_logger().warning(f"Failed to describe parameters: {error}")
        return response

    def _get(self, request: Any, response: Any) -> Any:
        try:
            response.values = [
                each.get_parameter_value() for each in self._node.get_parameters(list(request.names))
            ]
        except (ParameterNotDeclaredException, ParameterUninitializedException) as error:
            self._node.get_logger().warning(f"Failed to get parameters: {error}")
        return response

    def _get_types(self, request: Any, response: Any) -> Any:
        try:
            response.types = [each.value for each in self._node.get_parameter_types(list(request.names))]
        except ParameterNotDeclaredException as error:
            self._node.get_logger().warning(f"Failed to get parameter types: {error}")
        return response

    def _list(self, request: Any, response: Any) -> Any:
        response.result = self._node.list_parameters(list(request.prefixes), request.depth)
        return response

    def _set(self, request: Any, response: Any) -> Any:
        response.results = [self._set_together([each]) for each in request.parameters]
        return response

    def _set_atomically(self, request: Any, response: Any) -> Any:
        response.result = self._set_together(request.parameters)
        return response

    def _set_together(self, messages: Any) -> Any:
        try:
            return self._node.set_parameters_atomically(
                [Parameter.from_parameter_msg(each) for each in messages]
            )
        except ParameterNotDeclaredException as error:
            return rcl_interfaces.SetParametersResult(successful=False, reason=str(error))
