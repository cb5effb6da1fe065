"""Reads ``.msg``, ``.srv`` and ``.action`` files from a folder of interface packages."""

import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import NamedTuple

from sim.files.untrusted import decoding_fault, read_bytes, read_text
from sim.interfaces.interface_definition import Definition, DefinitionError, Kind
from sim.interfaces.notation import parse, require_interface_name, require_package_name

_KINDS: tuple[Kind, ...] = ("msg", "srv", "action")
_PARTS: Mapping[Kind, tuple[str, ...]] = {
    "srv": ("Request", "Response"),
    "action": ("Goal", "Result", "Feedback"),
}
_DIVISIONS: Mapping[Kind, str] = {
    "srv": "a service needs one line '---' between request and response",
    "action": "an action needs two lines '---', between goal and result and between result and feedback",
}
_MANIFEST_NAME = re.compile(r"<name>\s*([^<\s]+)\s*</name>")


class _File(NamedTuple):
    """A file, with the time and size that show whether it changed."""

    path: Path
    modified: int
    size: int


class DefinitionFolder:
    """The definitions in one interface package, or in packages side by side.

    A package contains ``msg/<Name>.msg``, ``srv/<Name>.srv`` or ``action/<Name>.action``. Its name is
    that in ``package.xml``, or the folder's name without such a file. The files are listed once, when
    the object is created, and read when they are needed.

    Raises:
        DefinitionError: the folder does not exist.
    """

    def __init__(self, folder: Path) -> None:
        if not folder.is_dir():
            raise DefinitionError(f"{folder}: there is no such folder to read interfaces from")
        self.folder = folder
        self._files: dict[tuple[str, str], dict[str, _File]] = {}
        for package_folder in [folder] if is_package(folder) else sorted(folder.iterdir()):
            for kind, path in _definition_files(package_folder):
                status = path.stat()
                files = self._files.setdefault((_package_name(package_folder), kind), {})
                files[path.stem] = _File(path, status.st_mtime_ns, status.st_size)

    def __eq__(self, other: object) -> bool:
        """Whether the other folder found the same files, unchanged since."""
        return isinstance(other, DefinitionFolder) and self._files == other._files

    __hash__ = None  # type: ignore[assignment]

    def packages(self) -> frozenset[str]:
        """Return the packages with at least one definition."""
        return frozenset(package for package, _ in self._files)

    def names(self, package: str, kind: Kind) -> tuple[str, ...]:
        """Return the sorted names of a package's interfaces of one kind."""
        return tuple(self._files.get((package, kind), ()))

    def parts(self, package: str, kind: Kind, name: str) -> tuple[Definition, ...]:
        """Read a file."""
        origin = str(self._files[package, kind][name].path)
        return interface_parts(self.text(package, kind, name), package, kind, name, origin)

    def text(self, package: str, kind: Kind, name: str) -> str:
        """Return the content of the file.

        Raises:
            DefinitionError: the file is not UTF-8 text or cannot be read, or ROS 2 does not allow the name of
                the package or interface.
        """
        path = self._files[package, kind][name].path
        require_package_name(package, str(path))
        require_interface_name(name, str(path))
        try:
            content = read_bytes(path)
        except OSError as error:
            raise DefinitionError(f"{path}: cannot be read: {error.strerror}") from None
        try:
            return content.decode("utf-8-sig")
        except UnicodeDecodeError as error:
            raise DefinitionError(f"{path}:{decoding_fault(error)}") from None


def interface_parts(text: str, package: str, kind: Kind, name: str, origin: str) -> tuple[Definition, ...]:
    """Parse a definition: lines of ``---`` divide the parts of a service or an action.

    ``origin`` is its file, which errors name.
    """
    if kind == "msg":
        return (parse(text, package, kind, name, origin=origin),)
    lines = text.splitlines()
    divisions = [index for index, line in enumerate(lines) if line.strip() == "---"]
    if len(divisions) != len(_PARTS[kind]) - 1:
        raise DefinitionError(f"{origin}: {_DIVISIONS[kind]}, not {len(divisions)}")
    starts = [0, *(division + 1 for division in divisions)]
    ends = [*divisions, len(lines)]
    # Blank lines replace the parts before, so that errors have the right line numbers.
    return tuple(
        parse("\n".join([""] * start + lines[start:end]), package, kind, f"{name}_{part}", origin=origin)
        for part, start, end in zip(_PARTS[kind], starts, ends, strict=True)
    )


def is_package(folder: Path) -> bool:
    """Whether a folder has definition files in ``msg``, ``srv`` or ``action``."""
    return any(True for _ in _definition_files(folder))


def _definition_files(package_folder: Path) -> Iterator[tuple[Kind, Path]]:
    for kind in _KINDS:
        for path in sorted((package_folder / kind).glob(f"*.{kind}")):
            yield kind, path


def _package_name(folder: Path) -> str:
    try:
        manifest = read_text(folder / "package.xml", errors="replace")
    except OSError:
        return folder.resolve().name
    found = _MANIFEST_NAME.search(manifest)
    return found[1] if found else folder.resolve().name
