"""The interfaces this process knows: rosbags' Jazzy messages, this package's definitions, a learner's own."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path
from typing import cast

from sim.interfaces.base import ActionType, Message, ServiceType, look_up_by
from sim.interfaces.interface_definition import Kind, UnknownInterfaceError
from sim.interfaces.registry import Registry

_FULL_NAME = re.compile(r"(?P<package>\w+)/(?P<kind>msg(?=/[^/]+$)|(?:srv|action)(?=/[^/_]+_))/(?P<name>\w+)")


def message(package: str, name: str) -> type[Message]:
    """Return a message class: ``message("std_msgs", "Int32")``.

    The class, and those of the messages it contains, are built when first asked for. Safe to call
    from several threads; every call returns the same class.

    Raises:
        UnknownInterfaceError: there is no such package or message; the text names the nearest.
        DefinitionError: its ``.msg`` file cannot be read.
    """
    return _registry().message(package, name)


def service(package: str, name: str) -> ServiceType:
    """Return a service class with its ``Request`` and ``Response``: ``service("std_srvs", "SetBool")``.

    Calling the service class itself raises `NotImplementedError`, as in rclpy. Safe to call from
    several threads; every call returns the same class.

    Raises:
        UnknownInterfaceError: there is no such package or service; the text names the nearest.
        DefinitionError: its ``.srv`` file cannot be read.
    """
    return _registry().service(package, name)


def action(package: str, name: str) -> ActionType:
    """Return an action class: ``action("example_interfaces", "Fibonacci")``.

    It has the messages ``Goal``, ``Result`` and ``Feedback``, and in ``Impl`` the services and
    messages that carry them. Calling the class itself raises `NotImplementedError`, as in rclpy.
    Safe to call from several threads; every call returns the same class.

    Raises:
        UnknownInterfaceError: there is no such package or action; the text names the nearest.
        DefinitionError: its ``.action`` file cannot be read.
    """
    return _registry().action(package, name)


def packages() -> frozenset[str]:
    """Return the names of all interface packages."""
    return _registry().packages()


def names(package: str, kind: Kind) -> tuple[str, ...]:
    """Return the sorted names of a package's messages (``"msg"``), services (``"srv"``) or actions.

    Raises:
        UnknownInterfaceError: there is no such package; the text names the nearest.
    """
    return _registry().names(package, kind)


def text(package: str, kind: Kind, name: str) -> str:
    """Return the definition of an interface as its author wrote it.

    Raises:
        UnknownInterfaceError: there is no such package or interface; the text names the nearest.
        DefinitionError: the file cannot be read.
    """
    return _registry().text(package, kind, name)


def add_definitions(folder: Path) -> None:
    """Make the interfaces of a folder known.

    The folder is an interface package (it holds ``msg``, ``srv`` or ``action`` with definition
    files), or holds such packages side by side. An interface that is already known by the same
    name is replaced, as by a workspace that overlays another; other names of its package stay.
    Classes handed out before stay as they are, so add folders before nodes are imported.

    Raises:
        DefinitionError: the folder does not exist. What is wrong with a file is told when its
            class is first asked for.
    """
    from sim.interfaces.folder import DefinitionFolder

    _registry().add(DefinitionFolder(folder))


def message_of_type(type_name: str) -> type[Message]:
    """Return a message class by full name; a request is ``std_srvs/srv/SetBool_Request``.

    The parts of an action are named as rosidl does: ``example_interfaces/action/Fibonacci_Goal``,
    ``…_Result``, ``…_Feedback``, ``…_FeedbackMessage``, ``…_SendGoal_Request`` and so on.

    Raises:
        UnknownInterfaceError: the name has another form, or as `message` and `service`.
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
    from sim.interfaces.folder import DefinitionFolder
    from sim.interfaces.jazzy import JazzyMessages

    return Registry(JazzyMessages(), DefinitionFolder(Path(__file__).parent / "definitions"))


look_up_by(message_of_type)
