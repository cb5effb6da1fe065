"""Threads, futures and tasks on virtual time hash to a number of their own, not to where they lie in memory.

The standard library keeps them in sets and goes through these: a pool joins its threads so, ``wait`` tells
which futures are done, a loop cancels its tasks. So the order of a set decides what runs next.
"""

import concurrent.futures
import threading
from collections.abc import Callable, Iterable
from itertools import count
from typing import Any

from sim.clock.virtual import VirtualClock


def _numbering(clock: VirtualClock) -> Callable[[Any], int]:
    """A ``__hash__``: a number drawn at the first call on the clock; others get what Python hashes it to."""
    numbers = count(1)

    def number(self: Any) -> int:
        known: int | None = getattr(self, "_number", None)
        if known is None:
            known = self._number = next(numbers) if clock.owns_current_thread() else object.__hash__(self)
        return known

    return number


def number_threads(clock: VirtualClock) -> None:
    """Have threads, and futures of pools, hash to numbers."""
    kinds: tuple[Any, ...] = (threading.Thread, concurrent.futures.Future)
    for kind in kinds:
        kind.__hash__ = _numbering(clock)
    futures: Any = concurrent.futures._base
    futures.id = hash  # it takes the locks of several futures in the order of their ids


def number_tasks(clock: VirtualClock) -> None:
    """Have tasks and futures of asyncio hash to numbers. Call it before they are imported by name."""
    import asyncio  # takes long, and most programs do without

    for module, name in ((asyncio.futures, "Future"), (asyncio.tasks, "Task")):
        in_c: Any = getattr(module, name)
        kind = type(name, (in_c,), {"__hash__": _numbering(clock), "__module__": in_c.__module__})
        setattr(module, name, kind)
        setattr(asyncio, name, kind)
    as_completed = asyncio.as_completed

    def in_order(fs: Any, *, timeout: float | None = None) -> Iterable[Any]:
        """``asyncio.as_completed``, beginning coroutines in the order given: it puts them into a set."""
        if not (asyncio.isfuture(fs) or asyncio.iscoroutine(fs)):
            fs = [asyncio.ensure_future(each) for each in dict.fromkeys(fs)]
        return as_completed(fs, timeout=timeout)

    tasks: Any = asyncio.tasks
    tasks.as_completed = asyncio.as_completed = in_order  # type: ignore[assignment]
