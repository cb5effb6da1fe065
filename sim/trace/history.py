"""Things that happened, kept in order of time and found by bisection."""

from bisect import bisect_left, bisect_right, insort_right
from collections.abc import Callable, Sequence
from typing import Generic, TypeVar

from sim.trace.model import Nanoseconds, Window

Item = TypeVar("Item")


class History(Generic[Item]):
    """Items in order of the time that ``when`` reads from them; of one time, in order of arrival.

    Adding the newest is an append; one that comes late finds its place.
    """

    __slots__ = ("_when", "items")

    def __init__(self, when: Callable[[Item], Nanoseconds]) -> None:
        self._when = when
        self.items: list[Item] = []

    def add(self, item: Item) -> None:
        """Take in an item."""
        items = self.items
        if not items or self._when(items[-1]) <= self._when(item):
            items.append(item)
        else:
            insort_right(items, item, key=self._when)

    def until(self, at: Nanoseconds) -> int:
        """How many items there are at or before ``at``."""
        return bisect_right(self.items, at, key=self._when)

    def latest(self, at: Nanoseconds) -> Item | None:
        """The last item at or before ``at``."""
        place = self.until(at)
        return self.items[place - 1] if place else None

    def within(self, window: Window) -> Sequence[Item]:
        """The items in the window."""
        first = bisect_left(self.items, window.start, key=self._when)
        after = bisect_left(self.items, window.end, lo=first, key=self._when)
        return self.items[first:after]
