"""Work in small pieces, for whoever has something else to do in between: a screen that has to answer keys."""

from collections.abc import Generator, Iterable, Iterator
from typing import TypeAlias, TypeVar

from sim.trace.model import Window

T = TypeVar("T")

Slices: TypeAlias = Generator[None, None, T]
"""Work that pauses after every piece, and returns what has come of it."""

PIECE = 250
"""Things that are looked at in a piece: some tenths of a millisecond to a few milliseconds."""


def at_once(work: Slices[T]) -> T:
    """Do all of the work, and give what comes of it."""
    while True:
        try:
            next(work)
        except StopIteration as over:
            result: T = over.value
            return result


def listed(things: Iterable[T]) -> Slices[list[T]]:
    """Put things into a list, some in every piece."""
    found: list[T] = []
    for thing in things:
        found.append(thing)
        if len(found) % PIECE == 0:
            yield
    return found


def parts(window: Window, things: int) -> Iterator[Window]:
    """Windows that make up one in which there are so many things: about a piece of them in each."""
    step = window.length // (things // PIECE + 1) + 1
    yield Window(window.start, min(window.start + step, window.end))
    for start in range(window.start + step, window.end, step):
        yield Window(start, min(start + step, window.end))
