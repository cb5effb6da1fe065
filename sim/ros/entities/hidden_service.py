"""Services that every node offers by itself; the trace does not show them."""

from collections.abc import Callable
from typing import Any

from sim.ros.entities.service import Service
from sim.ros.qos.qos import QoSProfile
from sim.ros.scheduling.callback_groups import CallbackGroup
from sim.ros.scheduling.entity import OwnerNode


def offer_hidden(
    node: OwnerNode,
    srv_type: Any,
    srv_name: str,
    callback: Callable[[Any, Any], Any],
    qos_profile: QoSProfile,
    callback_group: CallbackGroup | None = None,
) -> Service:
    """Offer a hidden service on a node, by default in the node's default group."""
    group = node.default_callback_group if callback_group is None else callback_group
    name = node.resolve_service_name(srv_name)
    with node.context.host.lock:
        service = Service(node, srv_type, name, callback, group, qos_profile)
        service.traced = False
        node._agenda.add(service)
        node.context.network.join_service(service)
    return service
