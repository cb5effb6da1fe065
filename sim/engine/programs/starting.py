"""Starts executables of packages and launch files by their names, for ``ros2`` lines and launch files.

Packages and launch files are imported at the first use: most runs need neither, and so start sooner.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from sim.engine.programs.program import program_of
from sim.engine.programs.programs import ProgramSupervisor
from sim.engine.setup import RunSetup
from sim.interfaces import add_definitions, find_definition_folders

if TYPE_CHECKING:
    from sim.packages import Packages
    from sim.shell import OnExit, Running


Launch: TypeAlias = "Callable[[ProgramSupervisor, ProgramStarter, Path, Sequence[str], OnExit], Running]"


class StartError(Exception):
    """A program or launch file cannot be started; the text is a sentence that says why, and where."""


class ProgramStarter:
    """Finds the packages around the programs, and starts their executables and launch files. Thread-safe.

    ``launch`` carries out a launch file.
    """

    def __init__(self, programs: ProgramSupervisor, setup: RunSetup, launch: Launch) -> None:
        self._programs = programs
        self._launch = launch
        self._folders = [*(Path(each.path) for each in setup.programs), *map(Path, setup.packages)]
        self._found: Packages | None = None
        self._numbers = count(1)

    def add_own_interfaces(self) -> None:
        """Make the ``.msg``, ``.srv`` and ``.action`` files around the programs importable."""
        for start in self._folders:
            for folder in find_definition_folders(start):
                add_definitions(folder)

    def packages(self) -> Packages:
        """Return the packages around the programs; searched for at the first call."""
        from sim.packages import find_packages, use_packages

        if self._found is None:
            self._found = find_packages(self._folders)
            use_packages(self._found)
        return self._found

    def close(self) -> None:
        """Remove the temporary folders of the packages."""
        if self._found is not None:
            self._found.close()

    def start_executable(
        self, package: str, executable: str, arguments: Sequence[str], on_exit: OnExit
    ) -> Running:
        """Start a program of a package.

        Raises:
            StartError: there is no such package or executable, or it cannot be read.
        """
        with _as_start_errors():
            found = self.packages().package(package).executable(executable)
        program = program_of(found, arguments)
        label = f"{executable}-{next(self._numbers)}"
        return self._programs.start(program, label, lambda outcome: on_exit(outcome.status))

    def launch(
        self, package: str | None, launch_file: str, arguments: Sequence[str], on_exit: OnExit
    ) -> Running:
        """Start a launch file, of a package or (None) by its path, with ``name:=value`` arguments.

        Raises:
            StartError: there is no such file, or it cannot be carried out.
        """
        with _as_start_errors():
            path = self._launch_path(package, launch_file)
            return self._launch(self._programs, self, path, arguments, on_exit)

    def describe_launch(self, package: str | None, launch_file: str) -> str:
        """Return what ``ros2 launch --show-args`` prints about a launch file.

        Raises:
            StartError: there is no such file, or it cannot be read.
        """
        from sim.launch import describe_arguments

        with _as_start_errors():
            return describe_arguments(self._launch_path(package, launch_file))

    def _launch_path(self, package: str | None, launch_file: str) -> Path:
        known = self.packages()  # a launch file needs the packages even if a path names it
        return Path(launch_file) if package is None else known.package(package).launch_file(launch_file)


@contextmanager
def _as_start_errors() -> Iterator[None]:
    """Raise errors of packages and launch files as StartError."""
    from sim.launch import LaunchError
    from sim.packages import PackageError

    try:
        yield
    except (LaunchError, PackageError) as error:
        raise StartError(str(error)) from error
