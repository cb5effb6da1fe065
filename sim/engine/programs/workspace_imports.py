"""Import hooks: packages of the workspace, the launch system, edited modules, asyncio on the run's clock."""

from __future__ import annotations

import importlib.util
import sys
from collections.abc import Callable, Sequence
from importlib.machinery import ModuleSpec, PathFinder
from types import ModuleType
from typing import TYPE_CHECKING, Any, cast

from sim.clock import RunClock, VirtualClock
from sim.clock.hashes import number_tasks
from sim.engine.programs.source import edited

if TYPE_CHECKING:
    from importlib.abc import Loader

    from sim.packages import Packages

_LAUNCH = frozenset(("ament_index_python", "launch", "launch_ros", "launch_xml", "launch_yaml"))


def use_workspace(packages: Callable[[], Packages], clock: RunClock) -> None:
    """Make the modules of ``packages`` and ``launch`` importable; put asyncio's loops on ``clock``."""
    sys.meta_path[:0] = (_AsyncioFinder(clock), _LaunchFinder(packages))
    sys.meta_path.append(_WorkspaceFinder(packages))
    if edited:
        sys.meta_path.insert(0, _EditedFinder())


class _LaunchFinder:
    """Finds the modelled launch system, before an installed real one."""

    def __init__(self, packages: Callable[[], Packages]) -> None:
        self._packages = packages

    def find_spec(
        self, fullname: str, _path: Sequence[str] | None = None, _target: ModuleType | None = None
    ) -> ModuleSpec | None:
        return ModuleSpec(fullname, _loader(self._install)) if fullname in _LAUNCH else None

    def _install(self, _module: ModuleType) -> None:
        from sim.launch.importing import install

        self._packages()
        install()


class _WorkspaceFinder:
    """Finds the Python packages of the workspace, after all other finders."""

    def __init__(self, packages: Callable[[], Packages]) -> None:
        self._packages = packages

    def find_spec(
        self, fullname: str, path: Sequence[str] | None = None, _target: ModuleType | None = None
    ) -> ModuleSpec | None:
        if path is not None:
            return None
        for package in self._packages():
            folder = package.module_folder
            if (folder / fullname / "__init__.py").is_file():
                return PathFinder.find_spec(fullname, [str(folder)])
        return None


class _EditedFinder:
    """Finds what the other finders do; of a file that is edited, the edited text is run."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        others = (each for each in (*sys.meta_path,) if each is not self)
        found = (each.find_spec(fullname, path, target) for each in others)
        spec = next((each for each in found if each is not None), None)
        if spec is not None and spec.origin is not None and (text := edited.get(spec.origin)) is not None:
            code = compile(text, spec.origin, "exec", dont_inherit=True)
            spec.loader = _loader(lambda module: exec(code, vars(module)))
        return spec


class _AsyncioFinder:
    """Lets Python import asyncio once, and then gives it event loops for the programs of a run."""

    def __init__(self, clock: RunClock) -> None:
        self._clock = clock

    def find_spec(
        self, fullname: str, _path: Sequence[str] | None = None, _target: ModuleType | None = None
    ) -> ModuleSpec | None:
        if fullname != "asyncio":
            return None
        sys.meta_path.remove(self)
        spec = importlib.util.find_spec(fullname)
        loader: Any = None if spec is None else spec.loader
        if spec is not None:
            spec.loader = _loader(loader.exec_module, self._use_own_loops)
        return spec

    def _use_own_loops(self, _module: ModuleType) -> None:
        from sim.clock.asyncio_loops import ProgramLoops

        ProgramLoops(self._clock).install()
        if isinstance(self._clock, VirtualClock):
            number_tasks(self._clock)


def _loader(*steps: Callable[[ModuleType], None]) -> Loader:
    """Return a loader that fills a module by steps, one after another."""
    return cast("Loader", _Loader(steps))


class _Loader:
    def __init__(self, steps: Sequence[Callable[[ModuleType], None]]) -> None:
        self._steps = steps

    def create_module(self, _spec: ModuleSpec) -> None:
        """Let Python create the module."""

    def exec_module(self, module: ModuleType) -> None:
        for step in self._steps:
            step(module)
