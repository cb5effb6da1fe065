"""The service that describes message types, and the parameter that disables it."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from sim.interfaces import Message, message, rcl_interfaces, service
from sim.interfaces.definition_text import message_text
from sim.ros.entities.hidden_service import offer_hidden
from sim.ros.middleware.type_description import contained_types, type_description, type_hash
from sim.ros.parameters.parameter import Parameter
from sim.ros.qos.qos import qos_profile_services_default

if TYPE_CHECKING:
    from sim.ros.node.node import Node

START_TYPE_DESCRIPTION_SERVICE_PARAM = "start_type_description_service"

_HASH = re.compile(r"RIHS01_[0-9a-f]{64}")


class TypeDescriptionService:
    """Declares the parameter on a node and, unless it is False, offers ``~/get_type_description``.

    The service describes the message types that the node publishes and subscribes to.
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
            offer_hidden(
                node, srv_type, "~/get_type_description", self._describe, qos_profile_services_default
            )
        self._node = node

    def _describe(self, request: Any, response: Any) -> Any:
        if not _HASH.fullmatch(request.type_hash):
            return _refused(response, "Failed to parse type hash")
        node = self._node
        types = {each.msg_type for each in node.publishers} | {each.msg_type for each in node.subscriptions}
        used = {str(type_hash(each)): each for each in types}
        wanted = used.get(request.type_hash)
        if wanted is None:
            return _refused(response, "Type not currently in use by this node")
        response.successful = True
        response.type_description = type_description(wanted)
        if request.include_type_sources:
            response.type_sources = [_source(each) for each in (wanted, *contained_types(wanted))]
        return response


def _refused(response: Any, reason: str) -> Any:
    response.successful = False
    response.failure_reason = reason
    return response


def _source(msg_type: type[Message]) -> Any:
    return message("type_description_interfaces", "TypeSource")(
        type_name=msg_type.__type_name__,
        encoding="msg",
        raw_file_contents=message_text(msg_type.__interface__.definition),
    )
