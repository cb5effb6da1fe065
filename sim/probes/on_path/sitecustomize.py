"""Starts the probe before the program, in every Python process that has this folder on its path."""

import os
import sys
from importlib.machinery import PathFinder
from importlib.util import module_from_spec
from pathlib import Path

from cbtui_probe import starting  # type: ignore[import-not-found] # it lies beside this file

_HERE = Path(__file__).parent


def _run_the_other() -> None:
    """Run the ``sitecustomize`` that this one hides, if there is one."""
    elsewhere = [folder for folder in sys.path if Path(folder or os.curdir).absolute() != _HERE]
    spec = PathFinder.find_spec("sitecustomize", elsewhere)
    if spec is not None and spec.loader is not None:
        spec.loader.exec_module(module_from_spec(spec))


starting.watch_imports()
_run_the_other()
