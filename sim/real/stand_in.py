"""Makes ``sim.shell`` import real rclpy instead of the model: the reverse of ``sim.ros.importing``."""

import importlib
import sys

_MODULES = {
    "actions": "action",
    "actions.graph": "action.graph",
    "context.context": "context",
    "entities.client": "client",
    "entities.publisher": "publisher",
    "entities.topic_endpoint_info": "topic_endpoint_info",
    "exceptions": "exceptions",
    "naming.expand_topic_name": "expand_topic_name",
    "naming.validation": "validate_full_topic_name",
    "node.node": "node",
    "node.parameter_client": "parameter_client",
    "parameters.parameter": "parameter",
    "qos.qos": "qos",
    "scheduling.executors": "executors",
    "scheduling.task": "task",
    "time.duration": "duration",
}
"""The modules of ``sim.ros`` that ``sim.shell`` uses, and their counterparts in rclpy."""


def install() -> None:
    """Replace the model's modules with rclpy's; call it before ``sim.shell`` is imported."""
    for model, real in _MODULES.items():
        sys.modules[f"sim.ros.{model}"] = importlib.import_module(f"rclpy.{real}")
