"""Reads what a ``setup.py`` and its ``setup.cfg`` install, without running them."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Iterator, Mapping
from configparser import ConfigParser
from configparser import Error as ConfigError
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import Any

from sim.files.untrusted import read_bytes, read_text
from sim.packages.errors import PackageError
from sim.packages.expressions import Expressions

_ENTRY_POINT = re.compile(
    r"\s*(?P<name>[^=\s][^=]*?)\s*=\s*(?P<module>[\w.]+)\s*:\s*(?P<function>[\w.]+)\s*(\[.*\])?\s*"
)
_READ_KEYS = frozenset(("name", "entry_points", "data_files", "scripts", "package_dir"))


@dataclass(frozen=True, slots=True)
class EntryPoint:
    """A function of a module that is a program; ``origin`` is the file and line of its declaration."""

    module: str
    function: str
    origin: str = ""


@dataclass(slots=True)
class Installed:
    """What a package installs: programs, and data files by their paths in the install folder."""

    entry_points: dict[str, EntryPoint] = field(default_factory=dict)
    scripts: dict[str, Path] = field(default_factory=dict)
    data_files: dict[PurePosixPath, Path] = field(default_factory=dict)
    source_folder: str = ""
    """The folder of its modules inside the package."""


def read_setup(root: Path) -> Installed:
    """Read the ``setup.py`` and ``setup.cfg`` in ``root``; either may be missing.

    Raises:
        PackageError: a file cannot be evaluated without running it.
    """
    installed = Installed()
    if (root / "setup.cfg").is_file():
        _read_cfg(root / "setup.cfg", installed)
    if (root / "setup.py").is_file():
        _read_py(root / "setup.py", installed)
    return installed


def _read_py(path: Path, installed: Installed) -> None:
    try:
        tree = ast.parse(read_bytes(path))
    except SyntaxError as error:
        raise PackageError(f"{path}:{error.lineno}: {error.msg}") from None
    except OSError as error:
        raise PackageError(f"{path}: {error.strerror}") from None
    except (ValueError, RecursionError, MemoryError):  # the parser's own limits
        raise PackageError(f"{path}: it is no Python that can be read") from None
    names = Expressions(path)
    for statement in _statements(tree.body):
        call = _setup_call(statement)
        if call is not None:
            _take(_keywords(call, names), path, installed)
            return
        names.carry_out(statement)
    raise PackageError(f"{path}: it does not call setup(), so that it installs nothing")


def _statements(body: Iterable[ast.stmt]) -> Iterator[ast.stmt]:
    """Yield the statements in order, those inside ``if`` and ``with`` too."""
    for each in body:
        if isinstance(each, (ast.If, ast.With)):
            yield from _statements(each.body)
        else:
            yield each


def _setup_call(statement: ast.stmt) -> ast.Call | None:
    match statement:
        case ast.Expr(value=ast.Call(func=ast.Name(id="setup") | ast.Attribute(attr="setup")) as call):
            return call
    return None


@dataclass(frozen=True, slots=True)
class _Keyword:
    value: Any
    origin: str
    lines: Mapping[str, int]
    """The line of each text in the value's source."""


def _keywords(call: ast.Call, names: Expressions) -> dict[str, _Keyword]:
    found: dict[str, _Keyword] = {}
    for each in call.keywords:
        if each.arg is None:
            place = names.place(each.value)
            found.update({key: _Keyword(value, place, {}) for key, value in names.value(each.value).items()})
        elif each.arg in _READ_KEYS:
            found[each.arg] = _Keyword(names.value(each.value), names.place(each.value), _lines(each.value))
    return found


def _lines(node: ast.expr) -> dict[str, int]:
    return {
        each.value: each.lineno
        for each in ast.walk(node)
        if isinstance(each, ast.Constant) and isinstance(each.value, str)
    }


def _take(keywords: Mapping[str, _Keyword], path: Path, installed: Installed) -> None:
    if "package_dir" in keywords:
        installed.source_folder = dict(keywords["package_dir"].value).get("", "")
    if "entry_points" in keywords:
        _take_entry_points(keywords["entry_points"], path, installed)
    if "scripts" in keywords:
        for script in keywords["scripts"].value:
            installed.scripts[PurePosixPath(script).name] = path.parent / script
    if "data_files" in keywords:
        keyword = keywords["data_files"]
        try:
            for folder, files in keyword.value:
                _take_files(folder, files, path.parent, installed)
        except (TypeError, ValueError):
            raise PackageError(
                f"{keyword.origin}: data_files is wanted as a list of (folder, [files])"
            ) from None


def _take_files(folder: str, files: Iterable[str], root: Path, installed: Installed) -> None:
    for each in files:
        installed.data_files[PurePosixPath(folder) / PurePosixPath(each).name] = root / each


def _take_entry_points(keyword: _Keyword, path: Path, installed: Installed) -> None:
    declared = keyword.value
    if isinstance(declared, str):
        sections = _sections(declared, keyword.origin)
        declared = {
            name: [f"{key} = {value}" for key, value in entries.items()] for name, entries in sections.items()
        }
    if not isinstance(declared, Mapping):
        raise PackageError(f"{keyword.origin}: entry_points is wanted as {{'console_scripts': [...]}}")
    scripts = declared.get("console_scripts", [])
    for text in scripts.splitlines() if isinstance(scripts, str) else scripts:
        if text.strip():
            line = keyword.lines.get(text)
            _take_entry_point(text, keyword.origin if line is None else f"{path}:{line}", installed)


def _take_entry_point(text: str, origin: str, installed: Installed) -> None:
    form = _ENTRY_POINT.fullmatch(text)
    if form is None:
        raise PackageError(
            f"{origin}: the entry point {text.strip()!r} is wanted as 'name = package.module:function'"
        )
    installed.entry_points[form["name"]] = EntryPoint(form["module"], form["function"], origin)


def _read_cfg(path: Path, installed: Installed) -> None:
    try:
        sections = _sections(read_text(path), str(path))
    except UnicodeDecodeError:
        raise PackageError(f"{path}: it cannot be read as UTF-8 text") from None
    except OSError as error:
        raise PackageError(f"{path}: {error.strerror}") from None
    scripts = sections.get("options.entry_points", {}).get("console_scripts", "")
    for text in scripts.splitlines():
        if text.strip():
            _take_entry_point(text, str(path), installed)
    for script in sections.get("options", {}).get("scripts", "").split():
        installed.scripts[PurePosixPath(script).name] = path.parent / script
    for folder, patterns in sections.get("options.data_files", {}).items():
        for pattern in re.split(r"[\n,]", patterns):
            _take_files(folder, _matching(pattern.strip(), path), path.parent, installed)


def _matching(pattern: str, path: Path) -> list[str]:
    """Return the files that match a pattern of a ``setup.cfg``."""
    if not pattern:
        return []
    if Path(pattern).is_absolute() or ".." in Path(pattern).parts:
        raise PackageError(f"{path}: {pattern} looks outside of the package")
    try:
        return sorted(map(str, path.parent.glob(pattern)))
    except (ValueError, IndexError):
        raise PackageError(f"{path}: {pattern!r} is no pattern of files") from None


def _sections(text: str, origin: str) -> dict[str, Any]:
    parser = ConfigParser(interpolation=None, delimiters=("=",))
    parser.optionxform = str  # type: ignore[assignment,method-assign]
    try:
        parser.read_string(text)
    except ConfigError as error:
        raise PackageError(f"{origin}: {' '.join(str(error).split())}") from None
    return {name: dict(parser[name]) for name in parser.sections()}
