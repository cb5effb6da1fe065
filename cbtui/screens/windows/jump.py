"""Letters over a screen: typing one goes to its place."""

from collections.abc import Mapping
from typing import ClassVar

from textual.app import ComposeResult
from textual.binding import BindingType
from textual.events import Click, Key
from textual.screen import ModalScreen
from textual.types import CSSPathType
from textual.widgets import Static

from cbtui.keys.action import Scope
from cbtui.keys.bindings import bindings_of
from cbtui.looks.theme import Charset
from cbtui.screens.sized import SizedScreen
from cbtui.widgets.jump import JumpTarget
from cbtui.widgets.key_bar import KeyBar


class JumpScreen(ModalScreen[str], SizedScreen[str]):
    """Shows letters at places of the screen below; a typed letter is the result, any other key leaves."""

    SCOPE: ClassVar[Scope] = Scope.JUMP
    CSS_PATH: ClassVar[CSSPathType | None] = "window.tcss"
    BINDINGS: ClassVar[list[BindingType]] = [*bindings_of(Scope.JUMP)]

    def __init__(self, places: Mapping[str, JumpTarget], charset: Charset) -> None:
        super().__init__()
        self._places = places
        self._charset = charset

    def compose(self) -> ComposeResult:
        """Lay out the letters."""
        for letter, target in self._places.items():
            text = letter if target.for_number else f"[{letter}]"
            label = Static(text, classes="letter", markup=False)
            label.styles.offset, label.styles.width = target.place, len(text)
            yield label
        yield KeyBar(self.SCOPE, self._charset)

    def on_key(self, event: Key) -> None:
        """Go to the place of the letter."""
        event.stop()
        self.dismiss(event.character if event.character in self._places else None)

    def on_click(self, event: Click) -> None:
        """Leave."""
        self.dismiss(None)

    def action_close(self) -> None:
        """Leave without going anywhere."""
        self.dismiss(None)
