"""ROS 2 message, service and action classes that behave as rclpy's, without a ROS 2 installation.

The messages of Jazzy's standard packages come from the rosbags library. Services, actions and the messages
that rosbags lacks are in ``definitions.interfaces``, in ROS 2's notation. A class is built when it is first
used, so importing this package is cheap.
"""

from sim.interfaces.base import ActionType, Message, ServiceType, copy_message, type_name
from sim.interfaces.cdr import from_cdr, to_cdr
from sim.interfaces.definition_text import definition
from sim.interfaces.finder import InterfaceFinder, interface_module
from sim.interfaces.interface_definition import DefinitionError, Kind, UnknownInterfaceError
from sim.interfaces.known import action, add_definitions, message, message_of_type, names, packages, service
from sim.interfaces.listing import interface_text, kinds_sentence
from sim.interfaces.workspace import find_definition_folders

__all__ = [
    "ActionType",
    "DefinitionError",
    "InterfaceFinder",
    "Kind",
    "Message",
    "ServiceType",
    "UnknownInterfaceError",
    "action",
    "add_definitions",
    "copy_message",
    "definition",
    "find_definition_folders",
    "from_cdr",
    "interface_module",
    "interface_text",
    "kinds_sentence",
    "message",
    "message_of_type",
    "names",
    "packages",
    "service",
    "to_cdr",
    "type_name",
]
