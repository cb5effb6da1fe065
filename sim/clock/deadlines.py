"""The queue of deadlines of virtual time: waiting threads and scheduled actions."""

from collections.abc import Callable
from functools import partial
from heapq import heappop, heappush
from itertools import count
from typing import TypeAlias

from sim.clock.virtual_threads import VirtualThread

Entry: TypeAlias = tuple[int, int, VirtualThread | Callable[[], None]]


class Deadlines:
    """A heap of deadlines; equal ones are in order of registration."""

    def __init__(self) -> None:
        # Every wait calls these, so they are bound C functions.
        self._heap: list[Entry] = []
        self.add: Callable[[Entry], None] = partial(heappush, self._heap)
        """Adds a deadline: its time, the number of the wait, and the thread or action."""
        self.take: Callable[[], Entry] = partial(heappop, self._heap)
        """Removes and returns the first entry; call ``first`` before."""
        self.number: Callable[[], int] = count(1).__next__
        """Returns the number of the next wait."""

    def first(self) -> int | None:
        """Return the earliest deadline; None if there is none."""
        heap = self._heap
        while heap:
            moment, number, due = heap[0]
            if not isinstance(due, VirtualThread) or (due.waiting and due.current_wait == number):
                return moment
            heappop(heap)
        return None

    def first_is_thread(self) -> bool:
        """Whether a thread waits for the earliest deadline; call ``first`` before."""
        return isinstance(self._heap[0][2], VirtualThread)

    def due_at(self, moment: int) -> list[VirtualThread | Callable[[], None]]:
        """Return the threads and actions whose deadline is a moment, in no order."""
        return [due for at, _, due in self._heap if at == moment]

    def later_than(self, now: int) -> list[int]:
        """Return all deadlines after ``now``."""
        return [moment for moment, *_ in self._heap if moment > now]
