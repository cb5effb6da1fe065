"""ROS 2 message and service classes that behave as rclpy's, without a ROS 2 installation.

The messages are those of Jazzy's standard packages, taken from the rosbags library; services and
the messages it lacks lie in ``definitions/`` as the ``.srv`` and ``.msg`` files ROS 2 uses. A class
is built when it is first asked for, so importing this package is cheap.
"""

from sim.ros.interfaces.base import Message, ServiceType, copy_message, type_name
from sim.ros.interfaces.cdr import definition, from_cdr, to_cdr
from sim.ros.interfaces.finder import InterfaceFinder, interface_module
from sim.ros.interfaces.interface_definition import DefinitionError, Kind
from sim.ros.interfaces.known import add_definitions, message, message_of_type, names, packages, service
from sim.ros.interfaces.mapping import MappingError, message_from_mapping
from sim.ros.interfaces.registry import UnknownInterfaceError

__all__ = [
    "DefinitionError",
    "InterfaceFinder",
    "Kind",
    "MappingError",
    "Message",
    "ServiceType",
    "UnknownInterfaceError",
    "add_definitions",
    "copy_message",
    "definition",
    "from_cdr",
    "interface_module",
    "message",
    "message_from_mapping",
    "message_of_type",
    "names",
    "packages",
    "service",
    "to_cdr",
    "type_name",
]
