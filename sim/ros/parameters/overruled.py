"""Notices what an on-set callback sets in vain: a parameter that is being set on the same thread."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager


class _Thread(threading.local):
    """The names of what a thread is setting, while callbacks are asked about it."""

    names: frozenset[str] = frozenset()


class Overruled:
    """Calls ``tell`` once for each name that is set while it is being set. Thread-safe."""

    def __init__(self, tell: Callable[[str], None]) -> None:
        self._tell = tell
        self._thread = _Thread()
        self._told: set[str] = set()

    @contextmanager
    def setting(self, names: Iterable[str]) -> Iterator[None]:
        """While callbacks are asked whether these may be set."""
        outer, inner = self._thread.names, frozenset(names)
        for name in sorted((inner & outer) - self._told):
            self._told.add(name)
            self._tell(name)
        self._thread.names = outer | inner
        try:
            yield
        finally:
            self._thread.names = outer
