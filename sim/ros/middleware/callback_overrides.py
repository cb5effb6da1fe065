"""Changes to a program without editing it: callback groups, and periods of timers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TypeAlias

CallbackKey: TypeAlias = tuple[str, str]
"""A node's full name ("" for any node) and a callback's name, or else its topic's or service's."""


class GroupChoice(StrEnum):
    """The callback group chosen for a callback."""

    OWN = "own"
    """A mutually exclusive group of its own."""
    SHARED = "shared"
    """A mutually exclusive group of all callbacks of the node with this choice."""
    REENTRANT = "reentrant"
    """A reentrant group of all callbacks of the node with this choice."""
    DEFAULT = "default"
    """The node's default group."""


@dataclass
class CallbackOverrides:
    """The changes; ``periods`` are nanoseconds. Everything else stays as in the program.

    A change for a node takes precedence over one for any node. Use it with the host's lock held.
    """

    groups: Mapping[CallbackKey, GroupChoice] = field(default_factory=dict)
    periods: Mapping[CallbackKey, int] = field(default_factory=dict)
    _callbacks: dict[CallbackKey, None] = field(default_factory=dict)
    _timers: dict[CallbackKey, None] = field(default_factory=dict)

    def group_choice(self, node: str, callback: str) -> GroupChoice | None:
        """Register a callback and return the group chosen for it; None: the program's own."""
        self._callbacks[node, callback] = None
        return self.groups.get((node, callback), self.groups.get(("", callback)))

    def period(self, node: str, callback: str, asked: int) -> int:
        """Register a timer and return its period, in nanoseconds."""
        self._timers[node, callback] = None
        return self.periods.get((node, callback), self.periods.get(("", callback), asked))

    def unmet(self) -> Iterator[str]:
        """Sentences on the changes that no callback has matched so far."""
        yield from _unmet(self.groups, self._callbacks, "callback")
        yield from _unmet(self.periods, self._timers, "timer callback")


def _unmet(
    changes: Mapping[CallbackKey, object], there: Mapping[CallbackKey, None], kind: str
) -> Iterator[str]:
    names = dict.fromkeys(callback for _, callback in there if callback)
    for node, callback in changes:
        if (node, callback) in there or (not node and callback in names):
            continue
        place = f" in {node}" if node and callback in names else ""
        are = "is" if len(names) == 1 else "are"
        known = f"there {are} {', '.join(names)}" if names else f"there was no {kind} at all"
        yield f"no {kind} is named {callback}{place}; {known}"
