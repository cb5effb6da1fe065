"""Words for the lines in which two texts differ."""

from collections.abc import Sequence
from itertools import takewhile


def changed_lines(before: str, after: str) -> str:
    """Say which lines were changed, by their numbers in the new text: ``lines 3 to 5 changed``; or ""."""
    old, new = before.splitlines(), after.splitlines()
    same = _same(old, new)
    first, last = same + 1, len(new) - _same(old[same:][::-1], new[same:][::-1])
    if old == new:
        return ""
    return f"lines {first} to {last} changed" if last > first else f"line {first} changed"


def _same(old: Sequence[str], new: Sequence[str]) -> int:
    """How many lines are the same at the beginning."""
    return sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], zip(old, new, strict=False)))
