"""Lifecycle nodes: other nodes, or they themselves, configure and activate them."""

from sim.ros.lifecycle.managed_entity import ManagedEntity, SimpleManagedEntity
from sim.ros.lifecycle.node import LifecycleNode, LifecycleNodeMixin
from sim.ros.lifecycle.publisher import LifecyclePublisher
from sim.ros.lifecycle.state_machine import LifecycleState, TransitionCallbackReturn

__all__ = [
    "LifecycleNode",
    "LifecycleNodeMixin",
    "LifecyclePublisher",
    "LifecycleState",
    "ManagedEntity",
    "Node",
    "Publisher",
    "SimpleManagedEntity",
    "State",
    "TransitionCallbackReturn",
]

Node = LifecycleNode
Publisher = LifecyclePublisher
State = LifecycleState
