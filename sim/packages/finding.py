"""Searches for packages around a file or in a workspace, within limits."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

from sim.files.untrusted import mode_of
from sim.packages.errors import PackageError, UnknownPackageError, listing
from sim.packages.manifest import MANIFEST, read_name
from sim.packages.package import Package

_MOST_FOLDERS = 2000
"""Folders searched for one start, so that a search in a home folder ends soon."""
_DEPTH = 3
"""Levels below a start or a workspace's ``src`` that are searched."""
_LEVELS_UP = 6
_NO_SOURCES = frozenset(("build", "install", "log", "node_modules", "__pycache__"))
_IGNORE_FILES = ("COLCON_IGNORE", "AMENT_IGNORE")


@dataclass(slots=True)
class Packages:
    """The found packages, by name. ``notes`` are sentences on packages that were left out, and why."""

    by_name: dict[str, Package] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)

    def __iter__(self) -> Iterator[Package]:
        return iter(self.by_name.values())

    def __contains__(self, name: object) -> bool:
        return name in self.by_name

    @property
    def names(self) -> list[str]:
        """The names of all of them, sorted."""
        return sorted(self.by_name)

    def package(self, name: str) -> Package:
        """Return a package by name.

        Raises:
            UnknownPackageError: there is no such package.
        """
        if name not in self.by_name:
            notes = "".join(f" ({note})" for note in self.notes)
            known = listing("known packages", self.names)
            raise UnknownPackageError(f"Package '{name}' not found; {known}{notes}")
        return self.by_name[name]

    def close(self) -> None:
        """Remove the temporary folders of the packages."""
        for package in self:
            package.close()


def find_packages(start: Path | Iterable[Path]) -> Packages:
    """Find the packages around each start: a launch file, a node's file, a package or a workspace.

    Searched are the start's folder and those below it, the package around the start and those beside it,
    and the ``src`` of the workspace around it. Of two packages of one name the first counts. A manifest
    that cannot be read is reported in ``notes``.
    """
    found = Packages()
    seen: set[Path] = set()
    for each in [start] if isinstance(start, Path) else start:
        folder = each.resolve() if each.is_dir() else each.resolve().parent
        budget = iter(range(_MOST_FOLDERS))
        for place, depth in _places(folder):
            for root in _roots(place, depth, budget):
                if root not in seen:
                    seen.add(root)
                    _add(root, found)
    return found


def _add(root: Path, found: Packages) -> None:
    try:
        name = read_name(root)
    except PackageError as error:
        found.notes.append(str(error))
        return
    if name in found:
        first = found.by_name[name].root
        found.notes.append(f"package '{name}' is in {first} and in {root}; the first one counts")
    else:
        found.by_name[name] = Package(name, root)


def _places(folder: Path) -> Iterator[tuple[Path, int]]:
    """Yield the folders to search, and the depth of each search."""
    around = [folder, *folder.parents][: _LEVELS_UP + 1]
    own = next((each for each in around if (each / MANIFEST).is_file()), None)
    if own is not None:
        yield own, 0
    yield folder, _DEPTH
    if own is not None and own.parent != Path(own.anchor):
        yield own.parent, 1
    source = next((each for each in around if each.name == "src"), None)
    if source is not None:
        yield source, _DEPTH
    workspace = next((each for each in around if (each / "src").is_dir()), None)
    if workspace is not None:
        yield workspace / "src", _DEPTH


def _roots(top: Path, depth: int, budget: Iterator[int]) -> Iterator[Path]:
    """Yield the package folders below ``top``, nearest first; packages are not searched for others."""
    waiting = deque([(top, depth)])
    while waiting and next(budget, None) is not None:
        folder, left = waiting.popleft()
        try:
            ignored = any(mode_of(folder / name) for name in _IGNORE_FILES)
            is_package = (folder / MANIFEST).is_file()
        except OSError:  # not readable, as some folders in /tmp
            continue
        if ignored:
            continue
        if is_package:
            yield folder
        elif left:
            waiting.extend((each, left - 1) for each in _subfolders(folder))


def _subfolders(folder: Path) -> list[Path]:
    try:
        return sorted(
            each
            for each in folder.iterdir()
            if each.is_dir() and not each.name.startswith(".") and each.name not in _NO_SOURCES
        )
    except OSError:
        return []
