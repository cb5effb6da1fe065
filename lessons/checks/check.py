"""A check: a demand on a run in words, and the function that judges a run by it."""

from collections.abc import Callable
from dataclasses import dataclass

from sim.trace.model import Nanoseconds
from sim.trace.timeline import Timeline


@dataclass(frozen=True, slots=True)
class Verdict:
    """The result of a check: what was expected, what was seen, and the moment to look at (None: nowhere)."""

    passed: bool
    expected: str
    seen: str
    at: Nanoseconds | None = None


@dataclass(frozen=True, slots=True)
class Check:
    """Something that a run must show.

    ``asks`` is a short text without a full stop and numbers; ``judge`` examines a whole run. It must accept
    any run, also one without the callbacks that it looks for.
    """

    asks: str
    judge: Callable[[Timeline], Verdict]
