"""The service that describes message types, and the parameter that switches it off."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sim.ros import rcl_interfaces
from sim.ros.hidden_service import offer_hidden
from sim.ros.interfaces import service
from sim.ros.parameter import Parameter
from sim.ros.qos import qos_profile_services_default

if TYPE_CHECKING:
    from sim.ros.node import Node

START_TYPE_DESCRIPTION_SERVICE_PARAM = "start_type_description_service"


class TypeDescriptionService:
    """Declares the parameter on a node and, unless it is false, offers ``~/get_type_description``.

    It answers every request that it has no description: types have no hashes here.
    """

    def __init__(self, node: Node) -> None:
        name = START_TYPE_DESCRIPTION_SERVICE_PARAM
        if not node.has_parameter(name):
            descriptor = rcl_interfaces.ParameterDescriptor(
                name=name,
                type=Parameter.Type.BOOL.value,
                description="If enabled, start the ~/get_type_description service.",
                read_only=True,
            )
            node.declare_parameter(name, True, descriptor)
        self.enabled = node.get_parameter(name).value is True
        if self.enabled:
            srv_type = service("type_description_interfaces", "GetTypeDescription")
            offer_hidden(node, srv_type, "~/get_type_description", _refuse, qos_profile_services_default)


def _refuse(request: Any, response: Any) -> Any:
    response.successful = False
    response.failure_reason = f"there is no description of {request.type_name} here"
    return response
