"""Interfaces as text, as the ``ros2 interface`` commands show them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import get_args

from sim.interfaces.interface_definition import Kind, UnknownInterfaceError
from sim.interfaces.known import action, message, names, packages, service, text
from sim.interfaces.notation import is_primitive, line_of, type_text

_KINDS: tuple[Kind, ...] = get_args(Kind)
_PLURALS = {"msg": "messages", "srv": "services", "action": "actions"}


def interface_names(kind: Kind | None = None) -> list[str]:
    """Return the full names, such as ``std_msgs/msg/Int32``, of all interfaces or those of one kind."""
    kinds = _KINDS if kind is None else (kind,)
    return sorted(
        f"{package}/{each}/{name}"
        for package in packages()
        for each in kinds
        for name in names(package, each)
    )


def interface_text(type_name: str) -> str:
    """Return a definition as ``ros2 interface show`` prints it.

    It is the text of the file with its comments; below every field that is a message stand that
    message's lines, without comments and indented by a tab.

    Raises:
        UnknownInterfaceError: the name has another form than ``std_msgs/msg/Int32``, or is unknown.
        DefinitionError: the file cannot be read.
    """
    package, kind, name = split_type_name(type_name)
    lines: list[str] = []
    for line in text(package, kind, name).splitlines():
        lines += (line.rstrip(), *_nested(line, package, depth=1))
    return "".join(f"{line}\n" for line in lines)


def prototype(type_name: str) -> str:
    """Return what ``ros2 interface proto`` prints: the default values as YAML, in quotes.

    Of a service it is the request, of an action the goal.

    Raises:
        UnknownInterfaceError, DefinitionError: as `interface_text`.
    """
    from sim.interfaces.rosidl_runtime_py.convert import message_to_yaml

    package, kind, name = split_type_name(type_name)
    if kind == "msg":
        cls = message(package, name)
    else:
        cls = service(package, name).Request if kind == "srv" else action(package, name).Goal
    return f'"{message_to_yaml(cls())}"\n'


def split_type_name(type_name: str) -> tuple[str, Kind, str]:
    """Return package, kind and name of ``std_msgs/msg/Int32``.

    Raises:
        UnknownInterfaceError: the name has another form.
    """
    parts = type_name.split("/")
    if len(parts) != 3 or not all(parts):
        raise UnknownInterfaceError(
            f"Invalid name {type_name!r}. Expected three parts separated by '/', such as std_msgs/msg/Int32"
        )
    package, kind, name = parts
    if kind not in _KINDS:
        raise UnknownInterfaceError(
            f"Invalid name {type_name!r}. Its middle part must be one of {', '.join(_KINDS)}"
        )
    return package, kind, name


def kinds_sentence(package: str) -> str:
    """Which kinds of interfaces a known package has: what to tell someone who imports another one."""
    return f"{package} has {' and '.join(_PLURALS[kind] for kind in _KINDS if names(package, kind))} only"


def _nested(line: str, package: str, depth: int) -> Iterator[str]:
    """Yield the lines of the message that a field holds."""
    field = line_of(line, place=package) if line.strip() != "---" else None
    form = type_text(field.type) if field else None
    if form is None or is_primitive(form.base):
        return
    owner, _, name = form.base.rpartition("/")
    for inner in text(owner or package, "msg", name).splitlines():
        content = inner.partition("#")[0].rstrip()
        if content:
            yield "\t" * depth + content
            yield from _nested(content, owner or package, depth + 1)
