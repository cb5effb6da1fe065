"""Does what CPython does at the end of a script, while the trace still takes events.

The engine exits by ``os._exit``, as daemon threads and C libraries may crash while an interpreter finalises.
So exit functions and destructors run here before that, and files are flushed.
"""

import atexit
import concurrent.futures.thread
import gc
import io
import sys
import threading
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from inspect import getclosurevars
from typing import Any

from sim.clock.virtual_threads import start_outside

GRACE = 3.0
"""Real seconds in which a program must end after its run; then it is ended by force."""
VIRTUAL_GRACE = 5_000_000_000
"""The same limit in nanoseconds of virtual time."""
TO_LEAVE = 1.5
"""Real seconds after ``GRACE`` in which an engine's process must be gone."""

# Kept from before a clock replaces it.
_Thread = threading.Thread
_join = threading.Thread.join

_TO_FLUSH = 0.3
"""Real seconds for flushing the files of a program that is ended by force."""


def set_engine_apart() -> set[str]:
    """Exclude all objects so far from garbage collection; return the names of the modules so far."""
    gc.freeze()
    return set(sys.modules)


def finalise(modules_before: set[str], is_own: Callable[[str], bool]) -> None:
    """Run exit functions, destroy what a program's modules hold, and flush its files.

    Modules imported since ``modules_before`` are dropped if ``is_own`` holds for their files. Objects that a
    daemon thread or a node on the network still uses are not destroyed; their files are flushed too.
    """
    for step in (
        run_thread_exit_functions,
        atexit._run_exitfuncs,
        _close_compressed,  # the collector may close a file of a cycle before the one that writes to it
        lambda: _drop_modules(modules_before, is_own),
        _close_compressed,
    ):
        try:
            step()
        except KeyboardInterrupt:  # the run's time was up meanwhile
            step()


def run_thread_exit_functions() -> None:
    """Run the functions that come before the joining of threads: thread pools end idle threads there.

    Where there is no pool, nothing is waited for: taking their lock would be a choice among threads.
    """
    exits: list[Callable[[], None]] = threading._threading_atexits  # type: ignore[attr-defined]
    pools: Any = concurrent.futures.thread
    while exits:
        if _registered(exits[-1]) is pools._python_exit and not pools._threads_queues:
            pools._shutdown = True
        else:
            exits[-1]()
        exits.pop()


def _registered(call: Callable[[], None]) -> object:
    """Return the function of an entry: a partial before Python 3.13, since then a lambda."""
    return call.func if isinstance(call, partial) else getclosurevars(call).nonlocals.get("func")


def _drop_modules(before: set[str], is_own: Callable[[str], bool]) -> None:
    for name in ("__main__", *(name for name in tuple(sys.modules) if name not in before)):
        file = getattr(sys.modules.get(name), "__file__", None) or ""
        if name == "__main__" or is_own(file):
            sys.modules.pop(name, None)
    gc.collect()


def flush_files() -> None:
    """Flush every file that is open for writing, text files before the binary files under them."""
    for file in sorted(_files(), key=lambda each: not isinstance(each, io.TextIOBase)):
        with suppress(Exception):  # CPython drops errors here, too
            file.flush()


def flush_files_soon() -> None:
    """Flush the files, but wait only a little: a pipe may be full."""
    flushing = _Thread(target=flush_files, daemon=True)
    start_outside(flushing)
    _join(flushing, _TO_FLUSH)


def _close_compressed() -> None:
    """Flush all files, and close compressed ones, which cannot be read without their end."""
    flush_files()
    for file in _files():
        if not isinstance(file, _PLAIN):
            with suppress(Exception):
                file.close()
    flush_files()


_PLAIN = (io.TextIOBase, io.BufferedWriter, io.BufferedRandom, io.RawIOBase, io.BytesIO)


def _files() -> list[Any]:
    every = gc.get_objects()
    kinds = {kind for kind in set(map(type, every)) if issubclass(kind, io.IOBase)}
    return [each for each in every if type(each) in kinds and _is_written(each)]


def _is_written(file: Any) -> bool:
    with suppress(Exception):
        return not file.closed and bool(file.writable())
    return False
