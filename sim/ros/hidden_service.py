"""Services that a node offers by itself: no part of a learner's program, so the trace does not show them."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from sim.ros.service import Service

if TYPE_CHECKING:
    from sim.ros.node import Node
    from sim.ros.qos import QoSProfile


class HiddenService(Service):
    """A service that runs as any other does, unseen."""

    traced = False


def offer_hidden(
    node: Node, srv_type: Any, srv_name: str, callback: Callable[[Any, Any], Any], qos_profile: QoSProfile
) -> HiddenService:
    """Have a node offer a hidden service, in its default group."""
    name = node.resolve_service_name(srv_name)
    with node.context.host.lock:
        service = HiddenService(node, srv_type, name, callback, node.default_callback_group, qos_profile)
        node._agenda.add(service)
        node.context.host.network.join_service(service)
    return service
