"""Installs the probe as soon as the program imports rclpy."""

from __future__ import annotations

import os
import sys
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec, PathFinder
from typing import TYPE_CHECKING, Any

from . import FOLDER
from .unseen import UNSEEN

if TYPE_CHECKING:
    from collections.abc import Sequence
    from types import ModuleType


def watch_imports() -> None:
    """Have the import of rclpy install the probe, if the environment asks for it."""
    if os.environ.get(FOLDER):
        sys.meta_path.insert(0, _RclpyFinder())


class _RclpyFinder(MetaPathFinder):
    """Finds rclpy once, and makes its loader install the probe."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Find ``rclpy`` alone."""
        if fullname != "rclpy":
            return None
        sys.meta_path.remove(self)
        spec = PathFinder.find_spec(fullname, path, target)
        if spec is not None and spec.loader is not None:
            _probe_when_loaded(spec.loader)
        return spec


def _probe_when_loaded(loader: Any) -> None:
    """Make a loader install the probe after it has loaded rclpy."""
    load = loader.exec_module

    def load_and_install(module: ModuleType) -> None:
        with UNSEEN:
            load(module)
        try:
            from .installing import install

            install(os.environ[FOLDER])
        except Exception as error:  # noqa: BLE001 - the program is worth more than its being watched
            sys.stderr.write(f"cbtui's probe cannot watch this rclpy, and leaves it alone: {error!r}\n")

    loader.exec_module = load_and_install
