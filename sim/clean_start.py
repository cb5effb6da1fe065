"""Starts processes that take no module from the current folder.

``multiprocessing`` has ``python -c`` begin them, which looks there first: a ``threading.py`` or ``signal.py``
that somebody keeps there would be run in the place of Python's own, before anything of ours is.
"""

import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager

_VARIABLE = "PYTHONSAFEPATH"
_OURS = "cbtui"
"""What tells our setting from a person's own."""
_starting = threading.Lock()


@contextmanager
def without_current_folder() -> Iterator[None]:
    """Let Python processes that are started meanwhile leave the current folder out; one thread at a time.

    They have the variable for it in their environment, until they call ``forget``.
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
    """Let what is started from here on look where Python looks by itself."""
    if os.environ.get(_VARIABLE) == _OURS:
        del os.environ[_VARIABLE]
