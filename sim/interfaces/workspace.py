"""Finds the interface packages around a learner's file."""

from collections import deque
from collections.abc import Iterator
from pathlib import Path
from typing import Final

from sim.files.untrusted import mode_of
from sim.interfaces.folder import is_package

MOST_FOLDERS: Final = 2000
"""The most folders that one search visits; further packages are not found."""

MOST_STEPS_UP: Final = 6
"""How many levels above the file its workspace can be."""

MOST_STEPS_DOWN: Final = 4
"""How many levels below a workspace's ``src`` a package can be."""

_NEVER: Final = frozenset(
    ("build", "install", "log", "node_modules", "site-packages", "__pycache__", "venv", "env")
)
"""Folders of build results and of environments; they contain copies of packages."""


def find_definition_folders(start: Path) -> list[Path]:
    """Return the interface packages around a file or folder, for `add_definitions` in this order.

    The search visits the folder of the file, the folders beside that folder, and the workspace:
    the nearest folder above that has a ``src`` and is not a package, or that contains several packages.
    A package is a folder with definition files in ``msg``, ``srv`` or ``action``. The nearest packages are
    last, so that of two packages with one name the nearer one counts. Folders that are hidden,
    marked with ``COLCON_IGNORE`` or made by colcon are skipped, links are not followed, and at
    most `MOST_FOLDERS` are visited, the nearest first.
    """
    start = start.absolute()
    beside = start if start.is_dir() else start.parent
    above = list(_folders_above(beside))
    search = _Search()
    found = [*search.packages_in(beside, depth=2)]
    found += [folder for folder in above if is_package(folder)]
    for folder in above[:1]:
        found += search.packages_in(folder, depth=1)
    for workspace in filter(None, map(_packages_of_workspace, above)):
        found += search.packages_in(workspace, depth=MOST_STEPS_DOWN)
        break
    return list(dict.fromkeys(found))[::-1]


class _Search:
    """One search, with the number of folders that it may still visit."""

    def __init__(self) -> None:
        self.left = MOST_FOLDERS

    def packages_in(self, root: Path, depth: int) -> Iterator[Path]:
        """Yield the packages at most ``depth`` levels below ``root`` and ``root`` itself, level by level."""
        waiting = deque([(root, depth)])
        while waiting and self.left > 0:
            folder, levels = waiting.popleft()
            self.left -= 1
            if is_package(folder):
                yield folder
            elif levels > 0:
                waiting.extend((inner, levels - 1) for inner in _folders_in(folder))


def _folders_above(beside: Path) -> Iterator[Path]:
    """Yield the nearest folders above, up to the home, the temporary and the root folder."""
    # Most programs do not need it, and it is slow to import.
    import tempfile

    ends = {*_home(), Path(tempfile.gettempdir()), Path(beside.anchor)}
    for folder in list(beside.parents)[:MOST_STEPS_UP]:
        if folder in ends or beside in ends:
            return
        yield folder


def _home() -> Iterator[Path]:
    try:
        yield Path.home()
    except RuntimeError:  # the user id has no name, and HOME is not set
        return


def _packages_of_workspace(folder: Path) -> Path | None:
    """Return the folder with the packages of a workspace; ``None`` if this is not a workspace."""
    if (folder / "src").is_dir() and not (folder / "package.xml").is_file():
        return folder / "src"
    with_manifest = [inner for inner in _folders_in(folder) if (inner / "package.xml").is_file()]
    return folder if len(with_manifest) > 1 else None


def _folders_in(folder: Path) -> list[Path]:
    try:
        entries = sorted(folder.iterdir())
    except OSError:
        return []
    return [entry for entry in entries if _is_searched(entry)]


def _is_searched(entry: Path) -> bool:
    try:
        return (
            not entry.name.startswith(".")
            and entry.name not in _NEVER
            and not entry.is_symlink()
            and entry.is_dir()
            and not mode_of(entry / "COLCON_IGNORE")
        )
    except OSError:  # another user's private folder, as in /tmp
        return False
