"""Looks after an engine from outside: how much it may take, and that nothing of it is left behind."""

import os
import threading
from collections.abc import Callable
from itertools import count

from cbtui.engines.process_tree import Family

CEILING = "CBTUI_MEMORY_GB"
"""The environment variable that says how much memory a node and what it starts may use."""

_GB = 1_000_000_000
_LOOK = 0.1
"""Seconds between two looks."""
_LOOKS_A_FAMILY = 5
"""Looks at the engine alone, and that one among them which goes to all that came of it."""
_MOST_PROCESSES = 64
_USUAL_CEILING = 4 * _GB


class BadCeilingError(Exception):
    """A ceiling that is none; the text is a sentence."""


def ceiling() -> int:
    """Bytes that an engine and what it starts may use: what the environment says, else 4 GB or half of all.

    Raises:
        BadCeilingError: what the environment says is no number of GB.
    """
    text = os.environ.get(CEILING)
    if text is None:
        return min(_USUAL_CEILING, os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") // 2)
    try:
        gigabytes = float(text)
    except ValueError:
        gigabytes = 0.0
    if not 0 < gigabytes < 1e6:
        raise BadCeilingError(f"{CEILING} has to be a number of GB above 0, such as 4, and is {text!r}")
    return int(gigabytes * _GB)


class Warden:
    """Watches a family on a thread of its own until the engine has ended, and ends what is left of it then.

    ``memory`` is in bytes. ``ask`` is called before a family is ended for what it takes, to have the engine
    write down where it stands.
    """

    def __init__(self, family: Family, memory: int, ask: Callable[[], None]) -> None:
        self._family = family
        self._memory = memory
        self._ask = ask
        self._thread = threading.Thread(target=self._watch, name="warden", daemon=True)
        self._over = threading.Event()
        self.verdict: str | None = None
        """What the engine was ended for, a sentence without its place; None if it was not."""

    def start(self) -> None:
        """Begin to watch."""
        self._thread.start()

    def stop(self) -> None:
        """End the family and the watch."""
        self._over.set()
        self._family.end()
        if self._thread.is_alive():
            self._thread.join()

    def wait(self, seconds: float) -> None:
        """Wait until the watch is over."""
        self._thread.join(seconds)

    def _watch(self) -> None:
        looks = count()
        while self._family.lives() and not self._over.wait(_LOOK):
            # Who came of whom is dear to find out where there are many threads.
            self.verdict = self._excess(whole=next(looks) % _LOOKS_A_FAMILY == 0)
            if self.verdict is not None:
                self._ask()
                break
        self._family.end()

    def _excess(self, whole: bool) -> str | None:
        processes = self._family.descendants() if whole else [self._family.pid]
        if len(processes) > _MOST_PROCESSES:
            return f"the node had more than {_MOST_PROCESSES} processes"
        if (
            self._family.memory(processes) > self._memory
            and self._family.own_memory(processes) > self._memory
        ):
            return f"the node used more than {self._memory / _GB:g} GB of memory"
        return None
