"""Makes ``import rclpy`` and ``from std_srvs.srv import SetBool`` mean this model, in this process."""

import importlib
import sys

from sim.ros.interfaces.finder import InterfaceFinder

_MODULES = (
    "_rclpy_pybind11",
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
    "impl.logging_severity",
    "impl.rcutils_logger",
    "logging",
    "logging_service",
    "node",
    "parameter",
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


def install() -> None:
    """Put the model in rclpy's place and make the interface packages importable; twice does no harm."""
    package = importlib.import_module("sim.ros")
    sys.modules["rclpy"] = package
    for name in _MODULES:
        sys.modules[f"rclpy.{name}"] = importlib.import_module(f"sim.ros.{name}")
    if not any(isinstance(finder, InterfaceFinder) for finder in sys.meta_path):
        sys.meta_path.append(InterfaceFinder())
