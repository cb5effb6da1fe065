"""Imports on virtual time: there are no switch points during an import.

An importing thread holds the interpreter's lock of the module. Another thread would wait for this lock while
it has the baton. CPython 3.11 to 3.13 look up the function that loads a module at every import.
"""

import importlib
from typing import Any

from sim.clock.replacing import Replacements


def replace_imports(replacements: Replacements) -> None:
    """Let each import run to its end, or to a wait, before other threads run."""
    clock = replacements.clock
    machinery: Any = importlib
    bootstrap = machinery._bootstrap
    real_load = bootstrap._find_and_load

    def load(*arguments: Any) -> Any:
        me = clock.current
        before, me.stays = me.stays, True
        try:
            return real_load(*arguments)
        finally:
            me.stays = before

    replacements.put(bootstrap, "_find_and_load", load)
