"""Limits the memory and processes of an engine's process tree, and ends what an engine leaves behind."""

import threading
from collections.abc import Callable
from itertools import count

from cbtui.engines.memory_limit import GB
from cbtui.engines.process_tree import ProcessTree, proportional, resident

_POLL_INTERVAL = 0.1
"""Seconds between two polls."""
_POLLS_PER_TREE_SCAN = 5
"""Every fifth poll reads the whole process tree, the others the engine alone."""
_MOST_PROCESSES = 64


class ResourceGuard:
    """Watches a process tree on a thread of its own, and ends the rest of it once the engine has ended.

    ``memory`` is in bytes. ``ask`` is called before a tree is ended for exceeding a limit, so that the engine
    can dump its stacks.
    """

    def __init__(self, tree: ProcessTree, memory: int, ask: Callable[[], None]) -> None:
        self._tree = tree
        self._memory = memory
        self._ask = ask
        self._thread = threading.Thread(target=self._watch, name="resource-guard", daemon=True)
        self._over = threading.Event()
        self.verdict: str | None = None
        """The exceeded limit as a sentence; None if the tree was not ended for one."""

    def start(self) -> None:
        """Start watching."""
        self._thread.start()

    def stop(self) -> None:
        """End the watch, which ends the process tree as its last act."""
        self._over.set()
        self._thread.join()

    def wait(self, seconds: float) -> None:
        """Wait for the end of the watch, at most a number of seconds."""
        self._thread.join(seconds)

    def _watch(self) -> None:
        looks = count()
        while self._tree.lives() and not self._over.wait(_POLL_INTERVAL):
            # Reading the whole tree costs far more than reading one process.
            self.verdict = self._excess(whole_tree=next(looks) % _POLLS_PER_TREE_SCAN == 0)
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
