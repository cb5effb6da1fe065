"""Deterministic hashes for threads, futures and tasks on virtual time, instead of memory addresses.

The standard library iterates over sets of them: a pool joins its threads, ``wait`` collects the finished
futures, a loop cancels its tasks. So the order of a set decides what runs next.
"""

import concurrent.futures
import threading
from collections.abc import Callable, Iterable
from itertools import count
from typing import Any

from sim.clock.virtual import VirtualClock


def _numbering(clock: VirtualClock) -> Callable[[Any], int]:
    """A ``__hash__`` that numbers objects at their first call on the clock; elsewhere Python's own hash."""
    numbers = count(1)

    def number(self: Any) -> int:
        known: int | None = getattr(self, "_number", None)
        if known is None:
            known = self._number = next(numbers) if clock.owns_current_thread() else object.__hash__(self)
        return known

    return number


def number_threads(clock: VirtualClock) -> None:
    """Give threads and futures of pools deterministic hashes."""
    kinds: tuple[Any, ...] = (threading.Thread, concurrent.futures.Future)
    for kind in kinds:
        kind.__hash__ = _numbering(clock)
    futures: Any = concurrent.futures._base
    futures.id = hash  # this module takes the locks of several futures in the order of their ids


def number_tasks(clock: VirtualClock) -> None:
    """Give tasks and futures of asyncio deterministic hashes. Call this before they are imported by name."""
    import asyncio  # slow to import, and most programs do not use it

    for module, name in ((asyncio.futures, "Future"), (asyncio.tasks, "Task")):
        in_c: Any = getattr(module, name)
        kind = type(name, (in_c,), {"__hash__": _numbering(clock), "__module__": in_c.__module__})
        setattr(module, name, kind)
        setattr(asyncio, name, kind)
    as_completed = asyncio.as_completed

    def in_order(fs: Any, *, timeout: float | None = None) -> Iterable[Any]:
        """``asyncio.as_completed``, starting coroutines in the given order instead of a set's."""
        if not (asyncio.isfuture(fs) or asyncio.iscoroutine(fs)):
            fs = [asyncio.ensure_future(each) for each in dict.fromkeys(fs)]
        return as_completed(fs, timeout=timeout)

    tasks: Any = asyncio.tasks
    tasks.as_completed = asyncio.as_completed = in_order  # type: ignore[assignment]
