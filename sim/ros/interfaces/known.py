"""The interfaces this process knows: rosbags' Jazzy messages, this package's definitions, a learner's own."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

from sim.ros.interfaces.base import Message, ServiceType, assemble
from sim.ros.interfaces.interface_definition import Kind
from sim.ros.interfaces.registry import Registry, UnknownInterfaceError

_FULL_NAME = re.compile(
    r"(?P<package>\w+)/(msg/(?P<message>\w+)|srv/(?P<service>\w+)_(?P<half>Request|Response))"
)


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


def packages() -> frozenset[str]:
    """Return the names of all interface packages."""
    return _registry().packages()


def names(package: str, kind: Kind) -> tuple[str, ...]:
    """Return the sorted names of a package's messages (``"msg"``) or services (``"srv"``).

    Raises:
        UnknownInterfaceError: there is no such package; the text names the nearest.
    """
    return _registry().names(package, kind)


def add_definitions(folder: Path) -> None:
    """Make the interfaces of a folder known: ``<folder>/<package>/msg/*.msg`` and ``…/srv/*.srv``.

    Raises:
        DefinitionError: the folder or a name in it is unusable, or an interface is already known.
            What is wrong inside a file is told when its class is first asked for.
    """
    from sim.ros.interfaces.folder import DefinitionFolder

    _registry().add(DefinitionFolder(folder))


def message_of_type(type_name: str) -> type[Message]:
    """Return a message class by full name; requests and responses are ``std_srvs/srv/SetBool_Request``.

    Raises:
        UnknownInterfaceError: the name has another form, or as `message` and `service`.
    """
    form = _FULL_NAME.fullmatch(type_name)
    if form is None:
        raise UnknownInterfaceError(
            f"{type_name!r} is not the full name of a message, request or response, "
            "such as std_msgs/msg/Int32 or std_srvs/srv/SetBool_Request"
        )
    if form["message"]:
        return message(form["package"], form["message"])
    owner = service(form["package"], form["service"])
    return owner.Request if form["half"] == "Request" else owner.Response


def restore(type_name: str, values: Mapping[str, Any]) -> Message:
    """Return the message that a pickle or a copy describes."""
    return assemble(message_of_type(type_name), values)


@cache
def _registry() -> Registry:
    from sim.ros.interfaces.folder import DefinitionFolder
    from sim.ros.interfaces.jazzy import JazzyMessages

    return Registry(JazzyMessages(), DefinitionFolder(Path(__file__).parent / "definitions"))
