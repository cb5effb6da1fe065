"""Limits the memory and processes of an engine from outside, and ends whatever it leaves behind."""

import threading
from collections.abc import Callable
from itertools import count

from cbtui.engines.memory_limit import GB
from cbtui.engines.process_tree import ProcessTree, proportional, resident

_LOOK = 0.1
"""Seconds between two looks."""
_LOOKS_A_TREE = 5
"""Every fifth look goes to the whole process tree, the others to the engine alone."""
_MOST_PROCESSES = 64


class ResourceGuard:
    """Watches a process tree on a thread of its own, and ends what is left of it once the engine has ended.

    ``memory`` is in bytes. ``ask`` is called before a tree is ended for exceeding a limit, to have the engine
    write down where it stands.
    """

    def __init__(self, tree: ProcessTree, memory: int, ask: Callable[[], None]) -> None:
        self._tree = tree
        self._memory = memory
        self._ask = ask
        self._thread = threading.Thread(target=self._watch, name="resource-guard", daemon=True)
        self._over = threading.Event()
        self.verdict: str | None = None
        """Which limit the engine was ended for, a sentence without its place; None if it was not."""

    def start(self) -> None:
        """Begin to watch."""
        self._thread.start()

    def stop(self) -> None:
        """End the process tree and the watch."""
        self._over.set()
        self._tree.end()
        if self._thread.is_alive():
            self._thread.join()

    def wait(self, seconds: float) -> None:
        """Wait until the watch is over."""
        self._thread.join(seconds)

    def _watch(self) -> None:
        looks = count()
        while self._tree.lives() and not self._over.wait(_LOOK):
            # To find all processes of the tree costs far more than to look at one.
            self.verdict = self._excess(whole_tree=next(looks) % _LOOKS_A_TREE == 0)
            if self.verdict is not None:
                self._ask()
                break
        self._tree.end()

    def _excess(self, whole_tree: bool) -> str | None:
        processes = self._tree.processes() if whole_tree else self._tree.engine()
        if len(processes) > _MOST_PROCESSES:
            return f"the node had more than {_MOST_PROCESSES} processes"
        if all(sum(map(memory, processes)) > self._memory for memory in (resident, proportional)):
            return f"the node used more than {self._memory / GB:g} GB of memory"
        return None
