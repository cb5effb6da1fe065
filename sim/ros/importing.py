"""Makes ``import rclpy`` and ``from std_srvs.srv import SetBool`` mean this model, in this process."""

import importlib
import sys
from collections.abc import Sequence
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import TYPE_CHECKING, Any, cast

from sim.ros.interfaces.finder import InterfaceFinder

if TYPE_CHECKING:
    from importlib.abc import Loader

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
    "constants",
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
_HELPERS = ("sensor_msgs_py", "sensor_msgs_py.point_cloud2", "test_msgs.message_fixtures")
"""Modules that are only loaded when a program imports them."""
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
        module = sys.modules[f"rclpy.{name}"] = importlib.import_module(f"sim.ros.{name}")
        _name_exceptions(module, f"rclpy.{name}")
    parser: Any = ModuleType("rosidl_parser", "The types that the slots of messages are made of.")
    parser.definition = importlib.import_module("sim.ros.interfaces.field_types")
    sys.modules["rosidl_parser"] = parser
    sys.modules["rosidl_parser.definition"] = parser.definition
    for name in _ROSIDL_MODULES:
        sys.modules[name] = importlib.import_module(f"sim.ros.interfaces.{name}")
    if not any(isinstance(finder, InterfaceFinder) for finder in sys.meta_path):
        sys.meta_path[:0] = (InterfaceFinder(), _HelperFinder())


class _HelperFinder:
    """Finds the helpers, and loads the model's modules in their place."""

    def find_spec(
        self, fullname: str, _path: Sequence[str] | None = None, _target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Return the spec of a helper, ``None`` for any other name."""
        if fullname not in _HELPERS:
            return None
        return ModuleSpec(fullname, cast("Loader", self), is_package="." not in fullname)

    def create_module(self, _spec: ModuleSpec) -> None:
        """Leave it to Python: the module is replaced when it is filled."""

    def exec_module(self, module: ModuleType) -> None:
        """Put the model's module in its place."""
        sys.modules[module.__name__] = importlib.import_module(f"sim.ros.{module.__name__}")


def _name_exceptions(module: ModuleType, name: str) -> None:
    """Have exceptions called by rclpy's name for the module that they come from: a traceback shows it."""
    for each in vars(module).values():
        if isinstance(each, type) and issubclass(each, BaseException):
            home = each.__module__.removeprefix("sim.ros.")
            if home != each.__module__ and (home == name.removeprefix("rclpy.") or home not in _MODULES):
                each.__module__ = name
