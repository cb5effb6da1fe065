"""Changes to a program without editing it: callback groups and timer periods."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from difflib import get_close_matches
from enum import StrEnum
from typing import TypeAlias, TypeVar

CallbackKey: TypeAlias = tuple[str, str]
"""A node's full name ("" for any node), and the name of a callback, or of its topic or service.

The name may lack the ending ``_callback``, as on screen.
"""

Override = TypeVar("Override")


class GroupChoice(StrEnum):
    """The callback group chosen for a callback."""

    OWN = "own"
    """A mutually exclusive group of its own."""
    SHARED = "shared"
    """One mutually exclusive group for all callbacks of the node with this choice."""
    REENTRANT = "reentrant"
    """One reentrant group for all callbacks of the node with this choice."""
    DEFAULT = "default"
    """The node's default group."""


@dataclass
class CallbackOverrides:
    """Overrides of groups and of timer periods, in nanoseconds.

    An override for a node takes precedence over one for any node. Use it with the host's lock held.
    """

    groups: Mapping[CallbackKey, GroupChoice] = field(default_factory=dict)
    periods: Mapping[CallbackKey, int] = field(default_factory=dict)
    _callbacks: dict[CallbackKey, None] = field(default_factory=dict)
    _timers: dict[CallbackKey, None] = field(default_factory=dict)

    def group_choice(self, node: str, callback: str) -> GroupChoice | None:
        """Register a callback and return the group chosen for it; None: the program's own."""
        self._callbacks[node, callback] = None
        return _chosen(self.groups, node, callback)

    def period(self, node: str, callback: str, asked: int) -> int:
        """Register a timer and return its period, in nanoseconds."""
        self._timers[node, callback] = None
        chosen = _chosen(self.periods, node, callback)
        return asked if chosen is None else chosen

    def unmatched(self) -> Iterator[str]:
        """Sentences on the overrides that no callback has matched so far."""
        yield from _unmatched(self.groups, self._callbacks, "callback")
        yield from _unmatched(self.periods, self._timers, "timer callback")


def _names(callback: str) -> tuple[str, str]:
    return callback, callback.removesuffix("_callback")


def _chosen(overrides: Mapping[CallbackKey, Override], node: str, callback: str) -> Override | None:
    keys = ((place, name) for name in _names(callback) for place in (node, ""))
    return next((overrides[key] for key in keys if key in overrides), None)


def _unmatched(
    overrides: Mapping[CallbackKey, object], present: Mapping[CallbackKey, None], kind: str
) -> Iterator[str]:
    names = dict.fromkeys(callback for _, callback in present if callback)
    spellings = {spelling for name in names for spelling in _names(name)}
    there = {(node, spelling) for node, name in present for spelling in _names(name)}
    for node, callback in overrides:
        if (node, callback) in there or (not node and callback in spellings):
            continue
        owners = [at for at, name in present if node and callback in _names(name)]
        here = dict.fromkeys(name for at, name in present if name and at == node) or names
        place = f" in {node}" if owners else ""
        are = "is" if len(here) == 1 else "are"
        known = f"there {are} {', '.join(here)}" if here else f"there was no {kind} at all"
        near = [] if owners else get_close_matches(callback, sorted(spellings), 1, 0.75)
        meant = f"; did you mean {near[0]}?" if near else "".join(f"; {owner} has it" for owner in owners[:1])
        yield f"no {kind} is named {callback}{place}; {known}{meant}"
