"""``launch_ros.actions``."""

from sim.launch.launch_ros.actions.lifecycle_node import LifecycleNode
from sim.launch.launch_ros.actions.node import Node
from sim.launch.launch_ros.actions.settings import (
    PushROSNamespace,
    SetParameter,
    SetParametersFromFile,
    SetRemap,
    SetUseSimTime,
)
from sim.launch.launch_ros.actions.unsupported import (
    ComposableNodeContainer,
    LifecycleTransition,
    LoadComposableNodes,
    ROSTimer,
    RosTimer,
)

PushRosNamespace = PushROSNamespace

__all__ = [
    "ComposableNodeContainer",
    "LifecycleNode",
    "LifecycleTransition",
    "LoadComposableNodes",
    "Node",
    "PushROSNamespace",
    "PushRosNamespace",
    "ROSTimer",
    "RosTimer",
    "SetParameter",
    "SetParametersFromFile",
    "SetRemap",
    "SetUseSimTime",
]
