"""Makes ``import rclpy`` and ``from std_srvs.srv import SetBool`` mean this model, in this process."""

import importlib
import sys
from types import ModuleType
from typing import Any

from sim.ros.interfaces.finder import InterfaceFinder

_MODULES = (
    "_rclpy_pybind11",
    "action",
    "action.client",
    "action.graph",
    "action.server",
    "callback_groups",
    "client",
    "clock",
    "clock_type",
    "context",
    "duration",
    "event_handler",
    "exceptions",
    "executors",
    "expand_topic_name",
    "guard_condition",
    "handle",
    "impl",
    "impl.implementation_singleton",
    "impl.logging_severity",
    "impl.rcutils_logger",
    "lifecycle",
    "lifecycle.managed_entity",
    "lifecycle.node",
    "lifecycle.publisher",
    "logging",
    "logging_service",
    "node",
    "parameter",
    "parameter_client",
    "parameter_event_handler",
    "parameter_service",
    "publisher",
    "qos",
    "qos_overriding_options",
    "serialization",
    "service",
    "service_introspection",
    "signals",
    "subscription",
    "task",
    "time",
    "time_source",
    "timer",
    "topic_endpoint_info",
    "topic_or_service_is_hidden",
    "type_description_service",
    "type_hash",
    "type_support",
    "utilities",
    "validate_full_topic_name",
    "validate_namespace",
    "validate_node_name",
    "validate_parameter_name",
    "validate_topic_name",
    "wait_for_message",
    "waitable",
)
_ROSIDL_MODULES = (
    "rosidl_runtime_py",
    "rosidl_runtime_py.convert",
    "rosidl_runtime_py.get_interfaces",
    "rosidl_runtime_py.import_message",
    "rosidl_runtime_py.set_message",
    "rosidl_runtime_py.utilities",
)


def install() -> None:
    """Put the model in rclpy's place and make the interface packages importable; twice does no harm."""
    package = importlib.import_module("sim.ros")
    sys.modules["rclpy"] = package
    for name in _MODULES:
        sys.modules[f"rclpy.{name}"] = importlib.import_module(f"sim.ros.{name}")
    parser: Any = ModuleType("rosidl_parser", "The types that the slots of messages are made of.")
    parser.definition = importlib.import_module("sim.ros.interfaces.field_types")
    sys.modules["rosidl_parser"] = parser
    sys.modules["rosidl_parser.definition"] = parser.definition
    for name in _ROSIDL_MODULES:
        sys.modules[name] = importlib.import_module(f"sim.ros.interfaces.{name}")
    if not any(isinstance(finder, InterfaceFinder) for finder in sys.meta_path):
        sys.meta_path.insert(0, InterfaceFinder())
