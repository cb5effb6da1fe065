"""Message classes by their type; mirrors ``rosidl_runtime_py.import_message``."""

from sim.interfaces.rosidl_runtime_py.utilities import import_message_from_namespaced_type

__all__ = ["import_message_from_namespaced_type"]
