"""Interfaces as text, as the ``ros2 interface`` commands print them."""

from collections.abc import Iterator
from typing import get_args

from sim.interfaces.interface_definition import Kind, UnknownInterfaceError
from sim.interfaces.known import names, text
from sim.interfaces.notation import is_primitive, line_of, type_text

_KINDS: tuple[Kind, ...] = get_args(Kind)
_PLURALS = {"msg": "messages", "srv": "services", "action": "actions"}


def interface_text(type_name: str) -> str:
    """Return a definition as ``ros2 interface show`` prints it.

    It is the text of the file with its comments. Below every field that is a message are that
    message's lines, without comments and indented by a tab.

    Raises:
        UnknownInterfaceError: the name has another form than ``std_msgs/msg/Int32``, or is unknown.
        DefinitionError: the file cannot be read.
    """
    package, kind, name = _parts_of(type_name)
    lines: list[str] = []
    for line in text(package, kind, name).splitlines():
        lines += (line.rstrip(), *_nested(line, package, depth=1))
    return "".join(f"{line}\n" for line in lines)


def _parts_of(type_name: str) -> tuple[str, Kind, str]:
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
    """A sentence on the kinds of interfaces of a known package, for an import of another kind."""
    return f"{package} has {' and '.join(_PLURALS[kind] for kind in _KINDS if names(package, kind))} only"


def _nested(line: str, package: str, depth: int) -> Iterator[str]:
    """Yield the lines of the message in a field."""
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
