"""A package: its programs, its launch files and its share folder."""

from __future__ import annotations

import shutil
import tempfile
import weakref
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path, PurePosixPath

from sim.packages.cmake_file import CMAKE_FILE, read_cmake
from sim.packages.errors import PackageError, UnknownExecutableError, listing
from sim.packages.setup_file import EntryPoint, Installed, read_setup

_LAUNCH_ENDINGS = ("launch.py", "launch.xml", "launch.yaml", "launch.yml")


@dataclass(frozen=True, slots=True)
class Executable:
    """A program of a package: the file ``path`` as a script, or ``function`` of the module in it.

    ``folder`` is where imports look first; ``module`` and ``function`` are empty for a script.
    """

    name: str
    path: Path
    folder: Path
    module: str = ""
    function: str = ""


@dataclass(frozen=True, eq=False)
class Package:
    """A package in the folder ``root``. Its files are read at first use, which is not thread-safe."""

    name: str
    root: Path

    @cached_property
    def _installed(self) -> Installed:
        is_python = (self.root / "setup.py").is_file() or (self.root / "setup.cfg").is_file()
        if (self.root / CMAKE_FILE).is_file() and not (self.root / "setup.py").is_file():
            return read_cmake(self.root)
        if not is_python:
            raise PackageError(
                f"{self.root}: package {self.name!r} has neither a setup.py nor a {CMAKE_FILE}"
            )
        return read_setup(self.root)

    @property
    def module_folder(self) -> Path:
        """The folder of its Python packages; ``root`` if the build files cannot be read."""
        try:
            return self.root / self._installed.source_folder
        except PackageError:
            return self.root

    @property
    def executables(self) -> Mapping[str, EntryPoint | Path]:
        """The programs by name: entry points, and paths of scripts.

        Raises:
            PackageError: the package's build file cannot be read.
        """
        return {**self._installed.scripts, **self._installed.entry_points}

    def executable(self, name: str) -> Executable:
        """Return a program by name.

        Raises:
            UnknownExecutableError: the package has no such program.
            PackageError: the build file cannot be read, or names a file that does not exist.
        """
        found = self.executables.get(name)
        if found is None:
            known = listing("known executables", sorted(self.executables))
            raise UnknownExecutableError(f"No executable found: {name!r} in package {self.name!r}; {known}")
        if isinstance(found, EntryPoint):
            path, folder = self._module_path(name, found), self.root / self._installed.source_folder
            return Executable(name, path, folder, found.module, found.function)
        if not found.is_file():
            raise PackageError(
                f"package {self.name!r} installs the script {name!r}, but {found} does not exist"
            )
        return Executable(name, found, found.parent)

    def _module_path(self, name: str, entry: EntryPoint) -> Path:
        base = self.root / self._installed.source_folder / Path(*entry.module.split("."))
        for path in (base.with_name(f"{base.name}.py"), base / "__init__.py"):
            if path.is_file():
                return path
        raise PackageError(
            f"{entry.origin}: the executable {name!r} is in the module {entry.module}, "
            f"but there is no {base.with_name(f'{base.name}.py')}"
        )

    @property
    def share_files(self) -> Mapping[PurePosixPath, Path]:
        """The files that are installed in the share folder, by their paths in it.

        Raises:
            PackageError: the package's build file cannot be read.
        """
        share = PurePosixPath("share") / self.name
        return {
            place.relative_to(share): path
            for place, path in self._installed.data_files.items()
            if place.is_relative_to(share) and ".." not in place.parts
        }

    def launch_file(self, name: str) -> Path:
        """Return the source of an installed launch file, found by its name anywhere in the share folder.

        Raises:
            PackageError: the file is not installed; the text says whether the sources have it.
        """
        for place, path in self.share_files.items():
            if place.name == name and path.is_file():
                return path
        lost = next(iter(sorted(self.root.glob(f"**/{name}"))), None) if _is_plain(name) else None
        if lost is not None:
            raise PackageError(
                f"file '{name}' was not found in the share directory of package '{self.name}': "
                f"{lost.relative_to(self.root)} is there, but the package does not install it; "
                "add it to data_files in setup.py"
            )
        known = listing("known launch files", self.launch_files)
        raise PackageError(
            f"file '{name}' was not found in the share directory of package '{self.name}'; {known}"
        )

    @property
    def launch_files(self) -> list[str]:
        """The names of the installed launch files.

        Raises:
            PackageError: the package's build file cannot be read.
        """
        return sorted(place.name for place in self.share_files if place.name.endswith(_LAUNCH_ENDINGS))

    @cached_property
    def prefix(self) -> Path:
        """The folder that the package is installed in, with links to the sources.

        Raises:
            PackageError: the package's build file cannot be read.
        """
        links = [(Path("share") / self.name / place, path) for place, path in self.share_files.items()]
        prefix = Path(tempfile.mkdtemp(prefix=f"{self.name}-"))
        weakref.finalize(self, shutil.rmtree, prefix, ignore_errors=True)
        (prefix / "share" / self.name).mkdir(parents=True)
        for place, path in links:
            link = prefix / place
            try:
                link.parent.mkdir(parents=True, exist_ok=True)
                link.symlink_to(path.resolve())
            except (OSError, ValueError):  # a file in the place of a folder, or an invalid name
                raise PackageError(f"package {self.name!r} cannot install {path} as {place}") from None
        return prefix

    @property
    def share(self) -> Path:
        """The share folder, with links to the installed sources only.

        Raises:
            PackageError: the package's build file cannot be read.
        """
        return self.prefix / "share" / self.name

    def close(self) -> None:
        """Remove the folder of links, if there is one; otherwise it is removed at the process's exit."""
        prefix = vars(self).pop("prefix", None)
        if prefix is not None:
            shutil.rmtree(prefix, ignore_errors=True)


def _is_plain(name: str) -> bool:
    return not set(name) & set("*?[]/\\")
