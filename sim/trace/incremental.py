"""Long computations in small steps, so that a screen can handle keys in between."""

from collections.abc import Generator, Iterable, Iterator
from time import monotonic
from typing import TypeAlias, TypeVar

from sim.trace.model import Window

T = TypeVar("T")

Incremental: TypeAlias = Generator[None, None, T]
"""A computation that yields after every step, and returns its result."""

STEP_SIZE = 250
"""Items that are processed in a step, which takes from 0.1 ms to a few milliseconds."""


def within(seconds: float, work: Incremental[T]) -> T | None:
    """Go on with a computation for so long; returns its result, None if it is not at its end."""
    until = monotonic() + seconds
    try:
        while monotonic() < until:
            next(work)
    except StopIteration as over:
        result: T = over.value
        return result
    return None


def run_to_end(work: Incremental[T]) -> T:
    """Run a computation to its end without pauses, and return its result."""
    while True:
        try:
            next(work)
        except StopIteration as over:
            result: T = over.value
            return result


def collect(things: Iterable[T]) -> Incremental[list[T]]:
    """Collect items into a list, step by step."""
    found: list[T] = []
    for thing in things:
        found.append(thing)
        if len(found) % STEP_SIZE == 0:
            yield
    return found


def split(window: Window, things: int) -> Iterator[Window]:
    """Split a window with ``things`` items into windows of about one step's worth of items each."""
    step = window.length // (things // STEP_SIZE + 1) + 1
    yield Window(window.start, min(window.start + step, window.end))
    for start in range(window.start + step, window.end, step):
        yield Window(start, min(start + step, window.end))
