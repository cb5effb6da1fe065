"""How the figures of two runs are written, and a difference between them: ``2 more``, ``1.0 s shorter``."""

from collections.abc import Callable
from typing import NamedTuple

from sim.quantities.durations import duration
from sim.trace.model import Nanoseconds, Window


class Wording(NamedTuple):
    """How to format figures of a kind, and to word and assess a difference.

    ``noise`` is by how much they may differ on the real clock though nothing was changed, and a tenth of the
    figure in any case; with 0 every difference counts. ``twice_differs``: more than twice as many is never
    about the same.
    """

    format: Callable[[float], str]
    higher: str
    lower: str
    more_is_worse: bool = False
    noise: float = 0
    twice_differs: bool = False

    def on(self, *, is_real: bool) -> "Wording":
        """Return the wording for runs on the real clock, or on virtual time, which has no noise."""
        return self if is_real else self._replace(noise=0)

    def is_noise(self, first: float, second: float) -> bool:
        """Whether two figures are about the same."""
        if self.twice_differs and max(first, second) > 2 * min(first, second):
            return False
        return self.noise > 0 and abs(second - first) < max(self.noise, max(first, second) / 10)


def _length(nanoseconds: float) -> str:
    return duration(round(nanoseconds))


def metres(metres: float) -> str:
    """Return a distance as text: ``0.25 m``."""
    return f"{metres:.2f} m"


COUNTS = Wording("{:.0f}".format, "more", "fewer")
CALLS = COUNTS._replace(noise=5, twice_differs=True)
FLAWS = COUNTS._replace(more_is_worse=True)
ERRORS = FLAWS._replace(noise=1)
LOSSES = FLAWS._replace(noise=5)
WAITS = Wording(_length, "longer", "shorter", more_is_worse=True, noise=100_000_000)
AGES = WAITS._replace(higher="older", lower="fresher")
LATENESS = WAITS._replace(higher="later", lower="sooner")
RUNNING = WAITS._replace(more_is_worse=False, noise=10_000_000)
DISTANCES = Wording(metres, "farther", "less far")
ANGLES = Wording("{:.1f} rad".format, "more", "less")


def stretch(window: Window) -> str:
    """A window as text: ``0 to 12.4 s``, or ``at 0 s`` for a moment."""
    start, end = in_seconds(window.start), in_seconds(window.end)
    return f"at {start} s" if start == end else f"{start} to {end} s"


def in_seconds(nanoseconds: Nanoseconds) -> str:
    """Nanoseconds as a number of seconds: ``12.4``."""
    return f"{round(nanoseconds / 1e9, 3):g}" if nanoseconds < 100_000_000_000 else f"{nanoseconds / 1e9:.1f}"
