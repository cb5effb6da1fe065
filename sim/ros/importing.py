"""Makes ``import rclpy`` and ``from std_srvs.srv import SetBool`` mean this model, in this process."""

import importlib
import sys

from sim.ros.interfaces.finder import InterfaceFinder

_MODULES = (
    "_rclpy_pybind11",
    "callback_groups",
    "client",
    "clock",
    "context",
    "duration",
    "exceptions",
    "executors",
    "guard_condition",
    "logging",
    "logging_service",
    "node",
    "parameter",
    "parameter_service",
    "publisher",
    "qos",
    "service",
    "signals",
    "subscription",
    "task",
    "time",
    "time_source",
    "timer",
    "type_description_service",
    "utilities",
    "validate_parameter_name",
)


def install() -> None:
    """Put the model in rclpy's place and make the interface packages importable; twice does no harm."""
    package = importlib.import_module("sim.ros")
    sys.modules["rclpy"] = package
    for name in _MODULES:
        sys.modules[f"rclpy.{name}"] = importlib.import_module(f"sim.ros.{name}")
    if not any(isinstance(finder, InterfaceFinder) for finder in sys.meta_path):
        sys.meta_path.append(InterfaceFinder())
