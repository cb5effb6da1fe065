"""Parses the ``.msg`` notation line by line, by the rules of ROS 2's rosidl_adapter."""

import keyword
import re
from difflib import get_close_matches
from typing import Any, Final, NamedTuple, TypeAlias, cast

from rosbags.interfaces import Nodetype
from rosbags.interfaces.typing import BaseDesc, Constdefs, Fielddefs, FieldDesc, NameDesc

from sim.interfaces.field_types import INTEGER_LIMITS
from sim.interfaces.interface_definition import Definition, DefinitionError, Kind
from sim.interfaces.literal_text import literal_of

_PRIMITIVES: Final = frozenset(
    ("bool", "byte", "char", "float32", "float64", "string", "wstring", *INTEGER_LIMITS)
)

_MISLEADING: Final = {
    "time": "builtin_interfaces/Time",
    "duration": "builtin_interfaces/Duration",
    "int": "int32",
    "float": "float32",
    "double": "float64",
    "boolean": "bool",
    "str": "string",
}
"""The ROS 2 types for the type names of ROS 1 and of other languages."""

_FIELD_NAME = re.compile(r"(?!.*__)(?!.*_$)[a-z][a-z0-9_]*")
_PACKAGE_NAME = _FIELD_NAME
_CONSTANT_NAME = re.compile(r"[A-Z](_?[A-Z0-9])*")
_INTERFACE_NAME = re.compile(r"[A-Z][A-Za-z0-9]*")
_TYPE = re.compile(r"(?P<base>[^\[\]<>=]*)(<=(?P<length>[^\[\]]*))?(\[(?P<size>[^\[\]]*)\])?")

_Place: TypeAlias = str


class TypeText(NamedTuple):
    """A type as written: ``string<=5[<=3]`` has base ``string``, length ``5``, size ``<=3``."""

    base: str
    length: str | None
    size: str | None


class DefinitionLine(NamedTuple):
    """One line of a definition that is neither blank nor a comment."""

    place: _Place
    """The place of the line as ``file:line``."""
    type: str
    name: str
    value: str
    """The text after the name, or after the ``=`` of a constant."""
    is_constant: bool


class _Structure:
    """The constants and fields read so far."""

    def __init__(self) -> None:
        self.constants: Constdefs = []
        self.fields: Fielddefs = []
        self.defaults: dict[str, object] = {}
        self.places: dict[str, _Place] = {}


def parse(text: str, package: str, kind: Kind, name: str, *, origin: str) -> Definition:
    """Parse one structure in the ``.msg`` notation.

    Types without a package are messages of the same package, also in a service. ``origin`` names
    the text in errors, together with the line number.

    Raises:
        DefinitionError: a line is not in the notation, a name is invalid or defined twice, a type is
            unknown, or a value cannot be read.
    """
    structure = _Structure()
    for number, written in enumerate(text.splitlines(), start=1):
        line = line_of(written, place=f"{origin}:{number}")
        if line is not None:
            if line.is_constant:
                _add_constant(structure, line)
            else:
                _add_field(structure, line, package)
    return Definition(
        package, kind, name, structure.constants, structure.fields, structure.defaults, structure.places
    )


def line_of(written: str, *, place: _Place) -> DefinitionLine | None:
    """Parse one line; ``None`` for a blank line or a comment.

    Raises:
        DefinitionError: the name after the type is missing.
    """
    content = written.partition("#")[0].strip()
    if not content:
        return None
    of, *rest = content.split(None, 1)
    if not rest or rest[0].startswith("="):
        raise DefinitionError(
            f"{place}: {content!r} is neither a field, a constant nor a comment: the name is missing"
        )
    name, equals, value = rest[0].partition("=")
    if equals:
        return DefinitionLine(place, of, name.strip(), value.strip(), is_constant=True)
    name, *default = rest[0].split(None, 1)
    return DefinitionLine(place, of, name, default[0] if default else "", is_constant=False)


def type_text(written: str) -> TypeText | None:
    """Parse a type; ``None`` if the text is not a type."""
    form = _TYPE.fullmatch(written)
    return form and TypeText(form["base"], form["length"], form["size"])


def is_primitive(base: str) -> bool:
    """Whether this is the name of a primitive type, not of a message."""
    return base in _PRIMITIVES


def require_package_name(name: str, place: _Place) -> None:
    """Raise `DefinitionError` for a package name that ROS 2 does not allow."""
    if not _PACKAGE_NAME.fullmatch(name):
        raise DefinitionError(f"{place}: the package name {name!r} must be lower case words joined by '_'")


def require_interface_name(name: str, place: _Place) -> None:
    """Raise `DefinitionError` for a message, service or action name that ROS 2 does not allow."""
    if not _INTERFACE_NAME.fullmatch(name):
        raise DefinitionError(f"{place}: the name {name!r} must be letters and digits, the first a capital")


def _add_constant(structure: _Structure, line: DefinitionLine) -> None:
    if not _CONSTANT_NAME.fullmatch(line.name):
        raise DefinitionError(
            f"{line.place}: the constant name {line.name!r} must be capitals, digits and '_'"
        )
    _require_new(structure, line, "constant")
    if line.type not in _PRIMITIVES:
        raise DefinitionError(
            f"{line.place}: the constant {line.name!r} is of type {line.type!r}; "
            f"constants are of the types {', '.join(sorted(_PRIMITIVES))}"
        )
    if not line.value:
        raise DefinitionError(f"{line.place}: the constant {line.name!r} has no value")
    value = _read(line, f"constant {line.name!r}", line.type, is_list=False)
    structure.constants.append((line.name, cast("Any", line.type), cast("Any", value)))


def _add_field(structure: _Structure, line: DefinitionLine, package: str) -> None:
    if not _FIELD_NAME.fullmatch(line.name):
        raise DefinitionError(
            f"{line.place}: the field name {line.name!r} must be lower case words joined by '_'"
        )
    if keyword.iskeyword(line.name):
        raise DefinitionError(f"{line.place}: the field name {line.name!r} is a keyword of Python")
    _require_new(structure, line, "field")
    described, base, is_list = _described(line, package)
    structure.fields.append((line.name, described))
    if line.value:
        if base not in _PRIMITIVES:
            raise DefinitionError(
                f"{line.place}: the field {line.name!r} is a message and takes no default value"
            )
        structure.defaults[line.name] = _read(line, f"default of {line.name!r}", base, is_list=is_list)


def _require_new(structure: _Structure, line: DefinitionLine, noun: str) -> None:
    before = structure.places.setdefault(line.name, line.place)
    if before != line.place:
        raise DefinitionError(f"{line.place}: the {noun} {line.name!r} is defined twice; first at {before}")


def _read(line: DefinitionLine, subject: str, base: str, *, is_list: bool) -> object:
    try:
        return literal_of(line.value, base, is_list=is_list)
    except ValueError as error:
        raise DefinitionError(f"{line.place}: the {subject}, {line.value}, cannot be used: {error}") from None


def _described(line: DefinitionLine, package: str) -> tuple[FieldDesc, str, bool]:
    """Return a field's type in rosbags' notation, its base type, and whether it has several values."""
    form = type_text(line.type)
    if form is None:
        raise DefinitionError(f"{line.place}: {line.type!r} is not a type; write for example int32[<=5]")
    element = _element(line, form, package)
    if form.size is None:
        return element, form.base, False
    if not form.size:
        return (Nodetype.SEQUENCE, (element, 0)), form.base, True
    if form.size.startswith("<="):
        bound = _count(line, form.size.removeprefix("<="), "bound")
        return (Nodetype.SEQUENCE, (element, bound)), form.base, True
    return (Nodetype.ARRAY, (element, _count(line, form.size, "size"))), form.base, True


def _element(line: DefinitionLine, form: TypeText, package: str) -> BaseDesc | NameDesc:
    if form.length is not None and form.base not in ("string", "wstring"):
        raise DefinitionError(
            f"{line.place}: {line.type!r}: only string and wstring take a bound like '<=5' before the '['"
        )
    if form.base in _PRIMITIVES:
        length = _count(line, form.length, "bound") if form.length is not None else 0
        return (Nodetype.BASE, (cast("Any", form.base), length))
    owner, _, name = form.base.rpartition("/")
    if not _INTERFACE_NAME.fullmatch(name) or (owner and not _PACKAGE_NAME.fullmatch(owner)):
        raise DefinitionError(_unknown_type(line, form.base))
    return (Nodetype.NAME, f"{owner or package}/msg/{name}")


def _unknown_type(line: DefinitionLine, base: str) -> str:
    meant = _MISLEADING.get(base) or next(iter(get_close_matches(base, _PRIMITIVES, n=1)), None)
    advice = f"did you mean {meant!r}?" if meant else "a message is written as Name or package/Name"
    return f"{line.place}: there is no type {base!r}; {advice}"


def _count(line: DefinitionLine, text: str, noun: str) -> int:
    if not text.isdecimal() or int(text) == 0:
        raise DefinitionError(
            f"{line.place}: the {noun} {text!r} in {line.type!r} must be a positive integer"
        )
    return int(text)
