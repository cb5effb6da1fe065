"""The interfaces of this process: rosbags' Jazzy messages, this package's definitions, a learner's own.

A class, and the classes of the messages that it contains, are built when they are first used. Every call with
the same name returns the same class. All functions are thread-safe.

Raises:
    UnknownInterfaceError: there is no such package or interface; the text names the most similar one.
    DefinitionError: the definition file cannot be read.
"""

import re
from functools import cache
from pathlib import Path
from typing import cast

from sim.interfaces.base import ActionType, Message, ServiceType, look_up_by
from sim.interfaces.interface_definition import Kind, UnknownInterfaceError
from sim.interfaces.registry import Registry

_FULL_NAME = re.compile(r"(?P<package>\w+)/(?P<kind>msg(?=/[^/]+$)|(?:srv|action)(?=/[^/_]+_))/(?P<name>\w+)")


def message(package: str, name: str) -> type[Message]:
    """Return a message class: ``message("std_msgs", "Int32")``."""
    return _registry().message(package, name)


def service(package: str, name: str) -> ServiceType:
    """Return a service class with its ``Request`` and ``Response``: ``service("std_srvs", "SetBool")``."""
    return _registry().service(package, name)


def action(package: str, name: str) -> ActionType:
    """Return an action class: ``action("example_interfaces", "Fibonacci")``.

    It has the messages ``Goal``, ``Result`` and ``Feedback``, and in ``Impl`` the services and messages that
    carry them.
    """
    return _registry().action(package, name)


def packages() -> frozenset[str]:
    """Return the names of all interface packages."""
    return _registry().packages()


def names(package: str, kind: Kind) -> tuple[str, ...]:
    """Return the sorted names of a package's messages (``"msg"``), services (``"srv"``) or actions."""
    return _registry().names(package, kind)


def text(package: str, kind: Kind, name: str) -> str:
    """Return the definition of an interface as its author wrote it."""
    return _registry().text(package, kind, name)


def add_definitions(folder: Path) -> None:
    """Add the interfaces of a folder: an interface package, or packages side by side.

    They replace known interfaces of the same names, as a workspace overlays another one. Classes that were
    returned before stay as they are, so add folders before nodes are imported. Errors in a file are raised
    when its class is first used.

    Raises:
        DefinitionError: the folder does not exist.
    """
    from sim.interfaces.folder import DefinitionFolder

    _registry().add(DefinitionFolder(folder))


def message_of_type(type_name: str) -> type[Message]:
    """Return a message class by its full name, such as ``std_srvs/srv/SetBool_Request``.

    The parts of an action have rosidl's names: ``example_interfaces/action/Fibonacci_Goal``, ``…_Result``,
    ``…_Feedback``, ``…_FeedbackMessage``, ``…_SendGoal_Request`` and so on.
    """
    form = _FULL_NAME.fullmatch(type_name)
    if form is None:
        raise UnknownInterfaceError(
            f"{type_name!r} is not the full name of a message, request, response or event, "
            "such as std_msgs/msg/Int32 or std_srvs/srv/SetBool_Request"
        )
    kind = cast("Kind", form["kind"])
    return _registry().part(form["package"], kind, form["name"])


@cache
def _registry() -> Registry:
    from sim.interfaces.bundles import DefinitionBundle
    from sim.interfaces.jazzy import JazzyMessages

    return Registry(JazzyMessages(), DefinitionBundle(Path(__file__).parent / "definitions.interfaces"))


look_up_by(message_of_type)
