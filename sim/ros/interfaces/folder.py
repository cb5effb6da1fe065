"""Reading ``.msg`` and ``.srv`` files from a folder of interface packages."""

from __future__ import annotations

import keyword
import re
from pathlib import Path
from typing import TYPE_CHECKING

from rosbags.typesys import TypesysError
from rosbags.typesys.base import BASE_NAMES, BaseType, Cardinality, Field, NamedType, Type, create_field_desc
from rosbags.typesys.msg import MSGParser
from rosbags.typesys.peg import Failure, Success

from sim.ros.interfaces.interface_definition import Definition, DefinitionError, Kind

if TYPE_CHECKING:
    from rosbags.typesys.peg import Result

_NAME = re.compile(r"[A-Z][A-Za-z0-9]*")
_FIELD_NAME = re.compile(r"[a-z](_?[a-z0-9]+)*")
_PACKAGE_NAME = _FIELD_NAME
_TYPE_NAME = re.compile(r"\w+/msg/\w+")


class DefinitionFolder:
    """Source that reads ``<folder>/<package>/msg/<Name>.msg`` and ``<folder>/<package>/srv/<Name>.srv``.

    The files are listed once, when it is made, and read when asked for.

    Raises:
        DefinitionError: the folder does not exist, or a package or file name is not one ROS 2 takes.
    """

    def __init__(self, folder: Path) -> None:
        if not folder.is_dir():
            raise DefinitionError(f"{folder}: there is no such folder to read interfaces from")
        self.folder = folder
        self._files: dict[tuple[str, str], dict[str, Path]] = {}
        for kind in ("msg", "srv"):
            for path in sorted(folder.glob(f"*/{kind}/*.{kind}")):
                package = path.parent.parent.name
                _require_names(path, package)
                self._files.setdefault((package, kind), {})[path.stem] = path

    def packages(self) -> frozenset[str]:
        """Return the packages that hold at least one definition."""
        return frozenset(package for package, _ in self._files)

    def names(self, package: str, kind: Kind) -> tuple[str, ...]:
        """Return the sorted names of a package's messages or services."""
        return tuple(self._files.get((package, kind), ()))

    def message(self, package: str, name: str) -> Definition:
        """Read a ``.msg`` file."""
        path = self._files[package, "msg"][name]
        return parse(path.read_text(encoding="utf-8"), package, "msg", name, origin=str(path))

    def service(self, package: str, name: str) -> tuple[Definition, Definition]:
        """Read a ``.srv`` file."""
        path = self._files[package, "srv"][name]
        lines = path.read_text(encoding="utf-8").splitlines()
        divisions = [index for index, line in enumerate(lines) if line.strip() == "---"]
        if len(divisions) != 1:
            raise DefinitionError(
                f"{path}: a service needs one line '---' between request and response, not {len(divisions)}"
            )
        (division,) = divisions
        # Blank lines in place of the request keep the response's line numbers true in errors.
        request, response = lines[:division], [""] * (division + 1) + lines[division + 1 :]
        return (
            parse("\n".join(request), package, "srv", f"{name}_Request", origin=str(path)),
            parse("\n".join(response), package, "srv", f"{name}_Response", origin=str(path)),
        )


def parse(text: str, package: str, kind: Kind, name: str, *, origin: str) -> Definition:
    """Read one structure in the ``.msg`` notation.

    Types without a package are messages of the same package, in a service too. ``origin`` names
    the text in errors.

    Raises:
        DefinitionError: a line is not in the notation, or a field name is unusable or given twice.
    """
    try:
        (parsed,) = _Parser(f"MSG: {package}/msg/{name}\n{text}\n").specification()
    except TypesysError:
        raise DefinitionError(_first_bad_line(text, origin)) from None
    _require_fields(parsed.fields, origin)
    return Definition(
        package,
        kind,
        name,
        [(constant.name, constant.typ.value, constant.value) for constant in parsed.constants],
        [(entry.name, create_field_desc(entry.typ)) for entry in parsed.fields],
        {entry.name: entry.value for entry in parsed.fields if entry.value is not None},
    )


class _Parser(MSGParser):
    """rosbags' parser of the ``.msg`` notation, with ``wstring``."""

    def base_type(self, pos: int) -> Result[Type]:
        found = self.regex(pos, r"wstring\b(?!<=)")
        if isinstance(found, Failure):
            return super().base_type(pos)
        return Success(found.pos, Type(BaseType(BASE_NAMES["wstring"]), Cardinality.SCALAR, 0, 0))

    def bounded_string(self, pos: int) -> Result[Type]:
        found = self.regex(pos, r"wstring<=[0-9]+")
        if isinstance(found, Failure):
            return super().bounded_string(pos)
        bound = int(found.value.removeprefix("wstring<="))
        return Success(found.pos, Type(BaseType(BASE_NAMES["wstring"]), Cardinality.SCALAR, bound, 0))


def _first_bad_line(text: str, origin: str) -> str:
    for number, line in enumerate(text.splitlines(), start=1):
        if isinstance(_Parser(line).line(0), Failure):
            return f"{origin}:{number}: {line.strip()!r} is neither a field, a constant nor a comment"
    return f"{origin}: not in the .msg notation"


def _require_names(path: Path, package: str) -> None:
    if not _PACKAGE_NAME.fullmatch(package):
        raise DefinitionError(f"{path}: the package name {package!r} must be lower case words joined by '_'")
    if not _NAME.fullmatch(path.stem):
        raise DefinitionError(
            f"{path}: the name {path.stem!r} must be letters and digits, the first a capital"
        )


def _require_fields(fields: list[Field], origin: str) -> None:
    seen: set[str] = set()
    for entry in fields:
        if not _FIELD_NAME.fullmatch(entry.name):
            raise DefinitionError(
                f"{origin}: the field name {entry.name!r} must be lower case words joined by '_'"
            )
        if keyword.iskeyword(entry.name):
            raise DefinitionError(f"{origin}: the field name {entry.name!r} is a keyword of Python")
        if entry.name in seen:
            raise DefinitionError(f"{origin}: the field {entry.name!r} is defined twice")
        if isinstance(entry.typ.ref, NamedType) and not _TYPE_NAME.fullmatch(entry.typ.ref.name):
            raise DefinitionError(
                f"{origin}: the type of {entry.name!r}, {entry.typ.ref.name}, is not of the form package/Name"
            )
        seen.add(entry.name)
