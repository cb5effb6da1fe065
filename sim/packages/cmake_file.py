"""Reads the ``install()`` commands of a ``CMakeLists.txt``: scripts and data files."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path, PurePosixPath

from sim.files.untrusted import read_text
from sim.packages.errors import PackageError
from sim.packages.setup_file import Installed

CMAKE_FILE = "CMakeLists.txt"
_COMMAND = re.compile(r"\b(?P<name>project|set|install)\s*\((?P<words>[^()]*)\)", re.IGNORECASE)
_WORD = re.compile(r'"[^"]*"|[^\s"]+')
_COMMENT = re.compile(r"#[^\n]*")
_KINDS = frozenset(("PROGRAMS", "FILES", "DIRECTORY"))
_ENDS = frozenset(("RENAME", "PATTERN", "PERMISSIONS", "USE_SOURCE_PERMISSIONS", "COMPONENT", "OPTIONAL"))


def read_cmake(root: Path) -> Installed:
    """Read ``install(PROGRAMS …)``, ``install(FILES …)`` and ``install(DIRECTORY …)``.

    Everything else in a CMake file, such as compiling, is ignored.

    Raises:
        PackageError: the file cannot be read.
    """
    installed = Installed()
    try:
        text = read_text(root / CMAKE_FILE)
    except UnicodeDecodeError:
        raise PackageError(f"{root / CMAKE_FILE}: it cannot be read as UTF-8 text") from None
    except OSError as error:
        raise PackageError(f"{root / CMAKE_FILE}: {error.strerror}") from None
    variables: dict[str, str] = {"CMAKE_CURRENT_SOURCE_DIR": str(root)}
    for command in _COMMAND.finditer(_COMMENT.sub("", text)):
        words = [_filled(word.strip('"'), variables) for word in _WORD.findall(command["words"])]
        match command["name"].lower(), words:
            case "project", [name, *_]:
                variables["PROJECT_NAME"] = name
            case "set", [name, *values]:
                variables[name] = " ".join(values)
            case "install", [kind, *rest] if kind in _KINDS:
                _install(kind, rest, root, installed)
    return installed


def _filled(word: str, variables: dict[str, str]) -> str:
    return re.sub(r"\$\{(\w+)\}", lambda found: variables.get(found[1], found[0]), word)


def _install(kind: str, words: list[str], root: Path, installed: Installed) -> None:
    if "DESTINATION" not in words:
        return
    at = words.index("DESTINATION")
    destination = PurePosixPath(*words[at + 1 : at + 2])
    sources = [word for each in words[:at] if each not in _ENDS for word in each.split()]
    for source in sources:
        if kind == "DIRECTORY":
            for inside, path in _files_below(source, root):
                installed.data_files[destination / inside] = path
        elif kind == "PROGRAMS" and destination.parts[:1] == ("lib",):
            installed.scripts[PurePosixPath(source).name] = root / source
        else:
            installed.data_files[destination / PurePosixPath(source).name] = root / source


def _files_below(source: str, root: Path) -> Iterator[tuple[PurePosixPath, Path]]:
    """Yield the files of a folder, with the folder's name unless it ends in a slash, as CMake does."""
    folder = root / source
    base = folder if source.endswith("/") else folder.parent
    for path in sorted(folder.rglob("*")):
        if path.is_file():
            yield PurePosixPath(path.relative_to(base).as_posix()), path
