"""Places of a widget that can be gone to by typing a letter."""

from collections.abc import Callable, Iterator
from typing import NamedTuple, Protocol, runtime_checkable

from textual.geometry import Offset


class JumpTarget(NamedTuple):
    """A place, counted from the top left of its widget's content, and the action that goes there.

    ``for_number``: the letter takes the place of a number, and has no brackets of its own.
    """

    place: Offset
    go: Callable[[], object]
    for_number: bool = False


@runtime_checkable
class Jumpable(Protocol):
    """A widget with places to go to."""

    def jump_targets(self) -> Iterator[JumpTarget]:
        """Yield the places in view, the most important first."""
