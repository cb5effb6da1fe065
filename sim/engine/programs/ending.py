"""What CPython does once a script has ended, done while the trace still takes what comes of it.

The engine leaves by ``os._exit``, since daemon threads and libraries in C may not survive an interpreter that
tears itself down. So exit functions, destructors and the flushing of files are seen to here, before that.
"""

import atexit
import gc
import io
import sys
import threading
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from sim.clock.virtual_threads import start_outside

GRACE = 3.0
"""Real seconds that a program gets to end once its run is over; then it is ended by force."""
VIRTUAL_GRACE = 5_000_000_000
"""Virtual nanoseconds that it gets, on virtual time."""
TO_LEAVE = 1.5
"""Real seconds that an engine may need beyond the grace until its process is gone."""

# Kept from before a clock puts its own in its place.
_Thread = threading.Thread
_join = threading.Thread.join

_TO_FLUSH = 0.3
"""Real seconds for files to be flushed where a program is ended by force."""


def set_engine_apart() -> set[str]:
    """Have the garbage collector pass over all objects so far; returns the names of the modules so far."""
    gc.freeze()
    return set(sys.modules)


def finalise(modules_before: set[str], is_own: Callable[[str], bool]) -> None:
    """Run exit functions, destroy what a program's modules hold, and flush its files.

    Modules imported since ``modules_before`` are dropped if ``is_own`` says so of their files. What is still
    used, by a daemon thread or a node on the network, is not destroyed; its files are flushed all the same.
    """
    for step in (
        run_thread_exit_functions,
        atexit._run_exitfuncs,
        _close_compressed,  # in a cycle, the collector may end a file before what is written through it
        lambda: _drop_modules(modules_before, is_own),
        _close_compressed,
    ):
        try:
            step()
        except KeyboardInterrupt:  # the run's time was up meanwhile
            step()


def run_thread_exit_functions() -> None:
    """Run what is to run before threads are joined: thread pools end their idle threads there."""
    exits: list[Callable[[], None]] = threading._threading_atexits  # type: ignore[attr-defined]
    while exits:
        exits[-1]()
        exits.pop()


def _drop_modules(before: set[str], is_own: Callable[[str], bool]) -> None:
    for name in ("__main__", *(name for name in tuple(sys.modules) if name not in before)):
        file = getattr(sys.modules.get(name), "__file__", None) or ""
        if name == "__main__" or is_own(file):
            sys.modules.pop(name, None)
    gc.collect()


def flush_files() -> None:
    """Flush every file that is open for writing, those first that are written through others."""
    for file in sorted(_files(), key=lambda each: not isinstance(each, io.TextIOBase)):
        with suppress(Exception):  # CPython drops them here, too
            file.flush()


def flush_files_soon() -> None:
    """Flush the files, unless that takes long: a pipe may take nothing."""
    flushing = _Thread(target=flush_files, daemon=True)
    start_outside(flushing)
    _join(flushing, _TO_FLUSH)


def _close_compressed() -> None:
    """Flush all files, and write the ends of compressed ones, without which these cannot be read."""
    flush_files()
    for file in _files():
        if not isinstance(file, _PLAIN):
            with suppress(Exception):
                file.close()
    flush_files()


_PLAIN = (io.TextIOBase, io.BufferedWriter, io.BufferedRandom, io.RawIOBase, io.BytesIO)


def _files() -> list[Any]:
    return [each for each in gc.get_objects() if issubclass(type(each), io.IOBase) and _is_written(each)]


def _is_written(file: Any) -> bool:
    with suppress(Exception):
        return not file.closed and bool(file.writable())
    return False
