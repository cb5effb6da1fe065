"""``rclpy.node``, as programs import it; rclpy's module uses the messages too."""

from sim.interfaces.rcl_interfaces import (
    FloatingPointRange,
    IntegerRange,
    ListParametersResult,
    ParameterDescriptor,
    ParameterEvent,
    ParameterType,
    ParameterValue,
    SetParametersResult,
)
from sim.ros.node.node import *
from sim.ros.node.node_entities import *
