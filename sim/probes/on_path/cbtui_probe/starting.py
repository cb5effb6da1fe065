"""Puts the probe into rclpy as soon as the program imports it."""

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
            _probe_when_loaded(spec.loader)
        return spec


def _probe_when_loaded(loader: Any) -> None:
    """Have a loader put the probe into the module that it loads."""
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
