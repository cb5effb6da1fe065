"""What a person changed about a program without touching its text: callback groups, and timers' periods."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TypeAlias

Tuned: TypeAlias = tuple[str, str]
"""A node's full name ("" for any node) and a callback's name; the topic's or service's for what has none."""


class GroupWish(StrEnum):
    """Which callback group a callback is to be in."""

    OWN = "own"
    """A mutually exclusive one that has no other member."""
    SHARED = "shared"
    """The one mutually exclusive group of all callbacks of the node with this wish."""
    REENTRANT = "reentrant"
    """The one reentrant group of all callbacks of the node with this wish."""
    DEFAULT = "default"
    """The node's default group."""


@dataclass
class Tuning:
    """The changes; ``periods`` are nanoseconds. What is not named stays as the program says.

    A change for a node goes before one for any node. Used with the host's lock held.
    """

    groups: Mapping[Tuned, GroupWish] = field(default_factory=dict)
    periods: Mapping[Tuned, int] = field(default_factory=dict)
    _callbacks: dict[Tuned, None] = field(default_factory=dict)
    _timers: dict[Tuned, None] = field(default_factory=dict)

    def wish(self, node: str, callback: str) -> GroupWish | None:
        """The group that is wished for a callback that a node has now, None for the program's own."""
        self._callbacks[node, callback] = None
        return self.groups.get((node, callback), self.groups.get(("", callback)))

    def period(self, node: str, callback: str, asked: int) -> int:
        """The period of a timer that a node has now, in nanoseconds."""
        self._timers[node, callback] = None
        return self.periods.get((node, callback), self.periods.get(("", callback), asked))

    def unmet(self) -> Iterator[str]:
        """Sentences on the changes that no callback was there for, up to now."""
        yield from _unmet(self.groups, self._callbacks, "callback")
        yield from _unmet(self.periods, self._timers, "timer callback")


def _unmet(changes: Mapping[Tuned, object], there: Mapping[Tuned, None], kind: str) -> Iterator[str]:
    names = dict.fromkeys(callback for _, callback in there if callback)
    for node, callback in changes:
        if (node, callback) in there or (not node and callback in names):
            continue
        place = f" in {node}" if node and callback in names else ""
        are = "is" if len(names) == 1 else "are"
        known = f"there {are} {', '.join(names)}" if names else f"there was no {kind} at all"
        yield f"no {kind} is named {callback}{place}; {known}"
