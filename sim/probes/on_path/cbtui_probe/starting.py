"""Puts the probe into rclpy as soon as the program imports it."""

from __future__ import annotations

import os
import sys
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec, PathFinder
from typing import TYPE_CHECKING, Any

from . import FOLDER
from .unseen import UNSEEN

if TYPE_CHECKING:
    from collections.abc import Sequence
    from types import ModuleType


def watch_imports() -> None:
    """Have rclpy probed when it is imported; nothing without the environment variable that asks for it."""
    if os.environ.get(FOLDER):
        sys.meta_path.insert(0, _RclpyFinder())


class _RclpyFinder(MetaPathFinder):
    """Finds rclpy where it is, once, and has it probed when it has been loaded."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Find ``rclpy`` alone."""
        if fullname != "rclpy":
            return None
        sys.meta_path.remove(self)
        spec = PathFinder.find_spec(fullname, path, target)
        if spec is not None and spec.loader is not None:
            spec.loader = _ProbedLoader(spec.loader)
        return spec


class _ProbedLoader(Loader):
    """Loads a module as ``loader`` does, and puts the probe into it."""

    def __init__(self, loader: Loader) -> None:
        self._loader = loader

    def __getattr__(self, name: str) -> Any:
        return getattr(self._loader, name)

    def create_module(self, spec: ModuleSpec) -> ModuleType | None:
        """Make the module as its own loader does."""
        return self._loader.create_module(spec)

    def exec_module(self, module: ModuleType) -> None:
        """Run the module, and put the probe in place."""
        with UNSEEN:
            self._loader.exec_module(module)
        try:
            from .installing import install

            install(os.environ[FOLDER])
        except Exception as error:  # noqa: BLE001 - the program is worth more than its being watched
            sys.stderr.write(f"cbtui's probe cannot watch this rclpy, and leaves it alone: {error!r}\n")
