"""Imports on virtual time: a thread that imports is not left at switch points.

It holds the lock of the module, which is the interpreter's own: a thread that came for it would wait with the
baton in its hand. CPython 3.11 to 3.13 look up the function that loads a module each time.
"""

import importlib
from typing import Any

from sim.clock.replacing import Replacements


def replace_imports(replacements: Replacements) -> None:
    """Have each import that loads a module come to its end, or to a wait, before other threads go on."""
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
