"""Lets somebody outside follow what each synchroniser gets and hands on; the package itself says nothing."""

from collections.abc import Callable, Sequence
from typing import Any, Protocol


class Follower(Protocol):
    """Follows one synchroniser."""

    def got(self, index: int, stamp: int) -> None:
        """A message of the filter at an index comes in, with its stamp in nanoseconds."""

    def handed_on(self) -> None:
        """A set of messages is handed on."""


class _Nobody:
    def got(self, _index: int, _stamp: int) -> None:
        pass

    def handed_on(self) -> None:
        pass


def _nobody(_synchroniser: Any, _topics: Sequence[str]) -> Follower:
    return _Nobody()


follow: Callable[[Any, Sequence[str]], Follower] = _nobody
"""Called with each new synchroniser and the topics of its filters ("" for a filter without one)."""
