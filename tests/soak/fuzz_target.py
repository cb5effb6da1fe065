"""What is fuzzed: a reader of something from outside, with good samples, and how it may refuse."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Target:
    """A reader. ``take`` gets an input and a folder that it may write to; it raises ``refusals`` only.

    ``words`` are what means something in such inputs, put in here and there.
    """

    name: str
    take: Callable[[bytes, Path], object]
    samples: tuple[bytes, ...]
    words: tuple[bytes, ...] = ()
    refusals: tuple[type[Exception], ...] = ()


def text_of(data: bytes) -> str:
    """An input as text; bytes that are no UTF-8 become lone surrogates, as in names of files."""
    return data.decode("utf-8", "surrogateescape")


def listed(words: bytes) -> tuple[bytes, ...]:
    """Words that are written with a bar between them."""
    return tuple(words.split(b"|"))
