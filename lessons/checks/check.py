"""What a check is: something asked of a run in words, and the function that looks whether it is so."""

from collections.abc import Callable
from dataclasses import dataclass

from sim.trace.model import Nanoseconds
from sim.trace.timeline import Timeline


@dataclass(frozen=True, slots=True)
class Verdict:
    """What came of a check: what had to be seen, what was seen, and the moment to look at (None: nowhere)."""

    passed: bool
    expected: str
    seen: str
    at: Nanoseconds | None = None


@dataclass(frozen=True, slots=True)
class Check:
    """Something that a run must show.

    ``asks`` says what, in a few words that go on neither with a full stop nor with a number; ``judge``
    looks at a whole run. It must take any run, also one in which the callbacks it looks for are missing.
    """

    asks: str
    judge: Callable[[Timeline], Verdict]
