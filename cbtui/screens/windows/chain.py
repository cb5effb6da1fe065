"""The window that asks for a chain of messages to follow."""

from collections.abc import Callable, Collection, Sequence

from textual.app import ComposeResult
from textual.widgets import Static

from cbtui.keys.action import Scope
from cbtui.looks.theme import Charset
from cbtui.screens.windows.typed_line import LineScreen, TypedLine


class ChainScreen(LineScreen[tuple[str, ...]]):
    """Its result are the names of the chain, none to follow nothing; None if it was closed.

    ``names`` is the chain followed so far, ``known`` all topics and services on which something was sent.
    ``follow`` raises ``ChainError`` if a chain cannot be followed.
    """

    SCOPE = Scope.CHAIN
    heading = "Follow a chain of messages"

    def __init__(
        self,
        names: Sequence[str],
        known: Sequence[str],
        follow: Callable[[Sequence[str]], object],
        charset: Charset,
    ) -> None:
        super().__init__(charset)
        self._names = names
        self._known = known
        self._follow = follow

    def content(self) -> ComposeResult:
        """Lay out the question."""
        yield Static(
            "From which topic or service to which? What lies between is found. Empty: stop following.",
            markup=False,
        )
        line = TypedLine(":".join(self._names), self._take, "first:last, such as /scan:/cmd_vel")
        yield line
        yield Static(known_names(self._known), markup=False)
        yield line.refusal

    def _take(self, text: str) -> None:
        names = names_in(text)
        if names:
            self._follow(names)
        self.dismiss(names)


def known_names(names: Collection[str]) -> str:
    """Return the sentence on which topics and services a run has."""
    return f"Here {'are' if len(names) > 1 else 'is only'} {', '.join(names)}."


def names_in(text: str) -> tuple[str, ...]:
    """Return the names of a chain that was typed as ``/scan:/cmd_vel``, or without the slashes."""
    return tuple(f"/{name.strip().removeprefix('/')}" for name in text.split(":") if name.strip())
