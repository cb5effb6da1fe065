"""How fast a run really goes, beside the speed that was asked for."""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from time import monotonic

from sim.quantities.nanoseconds import SECOND
from sim.trace.model import Nanoseconds

_SPAN = 3.0
"""Real seconds over which the pace is measured."""
_GAP = 0.5
"""Real seconds without events, as while time stands, after which measuring begins anew."""
_SLOW = 0.8
"""The share of the asked speed below which the pace is worth telling."""


@dataclass
class PaceMeter:
    """Measures how far a run gets in real time. Not thread-safe; ``clock`` counts real seconds."""

    clock: Callable[[], float] = monotonic
    _asked: float | None = None
    _noted: deque[tuple[float, Nanoseconds]] = field(default_factory=deque)

    def note(self, end: Nanoseconds, asked: float | None) -> None:
        """Note the end of the run so far, and the asked speed, None if there is none or time stands."""
        now = self.clock()
        if asked != self._asked or (self._noted and now - self._noted[-1][0] > _GAP):
            self._noted.clear()
        self._asked = asked
        self._noted.append((now, end))
        while len(self._noted) > 1 and now - self._noted[1][0] >= _SPAN:
            self._noted.popleft()

    @property
    def slow(self) -> float | None:
        """Seconds of the run per real second where that is well below the asked speed, else None."""
        if self._asked is None or self.clock() - self._noted[-1][0] > _GAP:
            return None
        (first, start), (last, end) = self._noted[0], self._noted[-1]
        if last - first < _SPAN:
            return None
        pace = (end - start) / SECOND / (last - first)
        return pace if pace < _SLOW * self._asked else None
