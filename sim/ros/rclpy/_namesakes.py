"""The modules of rclpy that have only what others of the model have."""

import sys
from importlib.machinery import ModuleSpec
from importlib.util import module_from_spec

NAMESAKES = {
    "_rclpy_pybind11": "internals.compiled",
    "callback_groups": "scheduling.callback_groups",
    "client": "entities.client",
    "clock_type": "time.clock_type",
    "context": "context.context",
    "duration": "time.duration",
    "event_handler": "entities.event_handler",
    "exceptions": "exceptions",
    "expand_topic_name": "naming.expand_topic_name",
    "guard_condition": "entities.guard_condition",
    "handle": "handle",
    "logging_service": "node.logging_service",
    "parameter_client": "node.parameter_client",
    "parameter_event_handler": "node.parameter_event_handler",
    "parameter_service": "node.parameter_service",
    "publisher": "entities.publisher",
    "serialization": "entities.serialization",
    "service": "entities.service",
    "service_introspection": "entities.service_introspection",
    "signals": "context.signals",
    "subscription": "entities.subscription",
    "task": "scheduling.task",
    "time": "time.time",
    "time_source": "node.time_source",
    "topic_endpoint_info": "entities.topic_endpoint_info",
    "type_description_service": "node.type_description_service",
    "type_hash": "middleware.type_hash",
    "type_support": "entities.type_support",
    "utilities": "context.utilities",
    "waitable": "scheduling.waitable",
}
"""Where in ``sim.ros`` the content of each is."""


_OF_NAMES = ("InvalidServiceNameException", "InvalidTopicNameException")
VALIDATORS = {
    "validate_full_topic_name": _OF_NAMES,
    "validate_namespace": ("InvalidNamespaceException",),
    "validate_node_name": ("InvalidNodeNameException",),
    "validate_parameter_name": ("InvalidParameterException",),
    "validate_topic_name": _OF_NAMES,
}
"""What else is in the modules of one function each of ``sim.ros.naming.validation``."""


def put_into(package: str) -> None:
    """Make these modules of a package: each of the first has what ``*`` imports from the model's."""
    found = {name: [f"{of} import *"] for name, of in NAMESAKES.items()}
    for name, errors in VALIDATORS.items():
        found[name] = [f"naming.validation import {name}", f"exceptions import {', '.join(errors)}"]
    for name, imports in found.items():
        module = module_from_spec(ModuleSpec(f"{package}.{name}", None))
        for each in imports:
            exec(f"from sim.ros.{each}", vars(module))
        sys.modules[module.__name__] = module
