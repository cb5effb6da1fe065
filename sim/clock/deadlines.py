"""What virtual time comes to next: threads that wait until a moment, and actions."""

from collections.abc import Callable
from functools import partial
from heapq import heappop, heappush
from itertools import count
from typing import TypeAlias

from sim.clock.virtual_threads import VirtualThread

Entry: TypeAlias = tuple[int, int, VirtualThread | Callable[[], None]]


class Deadlines:
    """A heap of moments; of equal ones, the wait or action that began first comes first."""

    def __init__(self) -> None:
        # These three are asked in every wait: no function of Python's own stands in between.
        self._heap: list[Entry] = []
        self.add: Callable[[Entry], None] = partial(heappush, self._heap)
        """Adds a moment, the number of the wait, and what is due then."""
        self.take: Callable[[], Entry] = partial(heappop, self._heap)
        """Takes out what is due first; call ``first`` before."""
        self.number: Callable[[], int] = count(1).__next__
        """Returns the number of one more wait."""

    def first(self) -> int | None:
        """Return the earliest moment that something still waits for, None if nothing does."""
        heap = self._heap
        while heap:
            moment, number, due = heap[0]
            if not isinstance(due, VirtualThread) or (due.waiting and due.current_wait == number):
                return moment
            heappop(heap)
        return None

    def first_is_thread(self) -> bool:
        """Whether a thread waits for the earliest moment; call ``first`` before."""
        return isinstance(self._heap[0][2], VirtualThread)

    def later_than(self, now: int) -> list[int]:
        """Return all moments after ``now``."""
        return [moment for moment, *_ in self._heap if moment > now]

    def clear(self) -> None:
        """Forget all."""
        self._heap.clear()
