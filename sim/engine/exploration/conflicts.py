"""Finds accesses to shared data that another thread's access interrupted with an effect."""

from collections import defaultdict, deque
from collections.abc import Callable, Hashable
from dataclasses import dataclass
from typing import TypeAlias

from sim.clock import VirtualClock
from sim.trace.events import AccessesConflicted, AnyEvent

Data: TypeAlias = tuple[Hashable, int]
"""A name, and the identity of its owner: two objects have attributes of their own."""

_KEPT = 64
"""The number of latest accesses that are kept of each data."""


@dataclass(frozen=True)
class _Access:
    unit: Hashable
    file: str
    line: int
    writes: bool
    entity: int


class Conflicts:
    """Takes all accesses to shared data, and records each triple of conflicting places once.

    The accesses of a ``unit``, such as one call of a callback, should be atomic. They are not if another
    unit's access comes between two of them and one reads what the other wrote: then no order of whole units
    gives the same result.
    """

    def __init__(
        self, clock: VirtualClock, callback_here: Callable[[], int], record: Callable[[AnyEvent], None]
    ) -> None:
        self._clock = clock
        self._callback_here = callback_here
        self._record = record
        self._accesses: defaultdict[Data, deque[_Access]] = defaultdict(lambda: deque(maxlen=_KEPT))
        self._told: set[object] = set()

    def take(self, data: Data, unit: Hashable, file: str, line: int, writes: bool) -> None:
        """Take an access: a unit is about to use data at a line."""
        access = _Access(unit, file, line, writes, self._callback_here())
        between: list[_Access] = []
        for earlier in reversed(self._accesses[data]):
            if earlier.unit == unit:
                for other in between:
                    if other.writes != (earlier.writes and writes):
                        self._tell(str(data[0]), earlier, other, access)
                break
            between.append(earlier)
        self._accesses[data].append(access)

    def _tell(self, name: str, *accesses: _Access) -> None:
        places = tuple((each.file, each.line) for each in accesses)
        if (name, places) not in self._told:
            self._told.add((name, places))
            writes = tuple(each.writes for each in accesses)
            entities = tuple(each.entity for each in accesses)
            self._record(AccessesConflicted(self._clock.now(), name, places, writes, entities))
