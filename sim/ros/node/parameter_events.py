"""Publishes changes of a node's parameters on ``/parameter_events``."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sim.interfaces import rcl_interfaces
from sim.ros.entities.publisher import Publisher
from sim.ros.parameters.store import ParameterChange
from sim.ros.qos.qos import qos_profile_parameter_events

if TYPE_CHECKING:
    from sim.ros.node.node import Node


def parameter_event_publisher(node: Node) -> Publisher:
    """Create the publisher of a node's parameter events."""
    return node.create_publisher(
        rcl_interfaces.ParameterEvent, "/parameter_events", qos_profile_parameter_events
    )


def publish_change(publisher: Publisher, change: ParameterChange) -> None:
    """Publish a change; without a subscription nothing is sent, which keeps the trace short."""
    publisher.require_usable()
    node = publisher.node
    name = f"{node.get_namespace().rstrip('/')}/{node.get_name()}"  # as a program's class may override them
    if publisher.get_subscription_count() == 0:
        return
    event = rcl_interfaces.ParameterEvent(
        stamp=node.get_clock().now().to_msg(),
        node=name,
        new_parameters=[each.to_parameter_msg() for each in change.new],
        changed_parameters=[each.to_parameter_msg() for each in change.changed],
        deleted_parameters=[each.to_parameter_msg() for each in change.deleted],
    )
    publisher.publish(event)
