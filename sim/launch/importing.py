"""Makes ``launch``, ``launch_ros``, ``ament_index_python`` and related packages import this model."""

import importlib
import sys

_MODULES = (
    "ament_index_python",
    "ament_index_python.packages",
    "launch",
    "launch.action",
    "launch.actions",
    "launch.condition",
    "launch.conditions",
    "launch.event",
    "launch.event_handler",
    "launch.event_handlers",
    "launch.events",
    "launch.events.process",
    "launch.launch_context",
    "launch.launch_description",
    "launch.launch_description_sources",
    "launch.substitution",
    "launch.substitutions",
    "launch.utilities",
    "launch_ros",
    "launch_ros.actions",
    "launch_ros.descriptions",
    "launch_ros.parameter_descriptions",
    "launch_ros.substitutions",
    "launch_xml",
    "launch_xml.launch_description_sources",
    "launch_yaml",
    "launch_yaml.launch_description_sources",
)


def install() -> None:
    """Replace these packages by the model; idempotent."""
    for name in _MODULES:
        sys.modules[name] = importlib.import_module(f"sim.launch.{name}")
