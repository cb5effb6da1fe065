"""Starts Python processes that do not import modules from the current folder.

``multiprocessing`` starts them by ``python -c``, which looks there first: a ``threading.py`` or ``signal.py``
in that folder would run in place of Python's own, before any code of cbtui.
"""

import os
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager

_VARIABLE = "PYTHONSAFEPATH"
_OURS = "cbtui"
"""The variable's value, which differs from one that a person set."""
_starting = threading.Lock()


@contextmanager
def without_current_folder() -> Iterator[None]:
    """Keep the current folder out of the module path of processes started in the block.

    One thread at a time is in such a block. A started process has the setting in its environment until it
    calls ``forget``.
    """
    with _starting:
        if os.environ.get(_VARIABLE):
            yield
            return
        os.environ[_VARIABLE] = _OURS
        try:
            yield
        finally:
            forget()


def forget() -> None:
    """Undo the setting for processes that are started from here on."""
    if os.environ.get(_VARIABLE) == _OURS:
        del os.environ[_VARIABLE]


def left_out(environment: Mapping[str, str]) -> dict[str, str]:
    """Return an environment without the setting, for users' programs: these import what lies beside them."""
    return {name: value for name, value in environment.items() if (name, value) != (_VARIABLE, _OURS)}
