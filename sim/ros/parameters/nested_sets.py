"""Detects on-set callbacks that set a parameter which is being set on the same thread: that has no effect."""

import threading
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager


class _Thread(threading.local):
    """The names of the parameters that a thread is setting, during its on-set callbacks."""

    names: frozenset[str] = frozenset()


class NestedSetDetector:
    """Calls ``report`` once for each parameter that is set while it is being set. Thread-safe."""

    def __init__(self, report: Callable[[str], None]) -> None:
        self._report = report
        self._thread = _Thread()
        self._reported: set[str] = set()

    @contextmanager
    def setting(self, names: Iterable[str]) -> Iterator[None]:
        """The context in which the on-set callbacks for these parameters run."""
        outer, inner = self._thread.names, frozenset(names)
        for name in sorted((inner & outer) - self._reported):
            self._reported.add(name)
            self._report(name)
        self._thread.names = outer | inner
        try:
            yield
        finally:
            self._thread.names = outer
