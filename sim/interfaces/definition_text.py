"""Writes definitions in the ``.msg`` notation."""

from collections.abc import Iterator
from typing import cast

from rosbags.interfaces import Nodetype
from rosbags.interfaces.typing import FieldDesc

from sim.interfaces.base import Message
from sim.interfaces.interface_definition import Definition


def definition(cls: type[Message]) -> str:
    """Return the definitions of a message and of all contained messages, as a ``ros2msg`` schema of MCAP."""
    own, *contained = _with_contained(cls)
    return _lines(own) + "".join(
        f"{'=' * 80}\nMSG: {part.package}/{part.name}\n{_lines(part)}" for part in contained
    )


def message_text(definition: Definition) -> str:
    """Return a definition as a ``.msg`` file, with default values and short names for its own package."""
    constants = [f"{of} {name}={_literal(value)}" for name, of, value in definition.constants]
    fields = [
        f"{_type_text(of, definition.package)} {name}{_default(definition, name)}"
        for name, of in definition.fields
    ]
    return "".join(f"{line}\n" for line in (*constants, *fields))


def _with_contained(cls: type[Message]) -> list[Definition]:
    """Return a class's definition, and then those of all contained messages, each once, deepest last."""
    found: dict[str, Definition] = {}

    def visit(cls: type[Message]) -> None:
        if cls.__type_name__ not in found:
            found[cls.__type_name__] = cls.__interface__.definition
            for part in cls.__interface__.parts.values():
                visit(part)

    visit(cls)
    return list(found.values())


def _lines(definition: Definition) -> str:
    return "".join(f"{line}\n" for line in _full_lines(definition))


def _full_lines(definition: Definition) -> Iterator[str]:
    for name, of, value in definition.constants:
        yield f"{of} {name}={value}"
    for name, description in definition.fields:
        yield f"{_type_text(description, package=None)} {name}"


def _type_text(of: FieldDesc, package: str | None) -> str:
    """Return a field's type; messages of ``package`` are written without the package."""
    if of[0] == Nodetype.BASE:
        base, length = of[1]
        return f"{base}<={length}" if length else base
    if of[0] == Nodetype.NAME:
        owner, _, name = of[1].split("/")
        return name if owner == package else f"{owner}/{name}"
    element, size = of[1]
    count = str(size) if of[0] == Nodetype.ARRAY else f"<={size}" if size else ""
    return f"{_type_text(cast('FieldDesc', element), package)}[{count}]"


def _default(definition: Definition, name: str) -> str:
    return f" {_literal(definition.defaults[name])}" if name in definition.defaults else ""


def _literal(value: object) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    return f'"{value}"' if isinstance(value, str) else str(value)
