"""Asks for a program or a recording of the person's own."""

from time import time
from typing import ClassVar

from textual import on
from textual.app import ComposeResult
from textual.binding import BindingType
from textual.containers import Container
from textual.widgets import Input, Static

from cbtui.keys.action import Scope
from cbtui.keys.bindings import bindings_of
from cbtui.looks.theme import Charset
from cbtui.runs.setup.own_files import CannotOpenError, completed, entry_for
from cbtui.screens.console import console_of
from cbtui.screens.sized import SizedModal
from cbtui.text.cells import visible
from cbtui.widgets.key_bar import KeyBar

_MOST_NAMES = 24
"""Names that are listed at most."""


class PathInput(Input):
    """Where the path is typed; tab is the screen's."""

    def __init__(self) -> None:
        super().__init__(placeholder="my_node.py", compact=True, select_on_focus=False)


class OpenFileScreen(SizedModal[None]):
    """Opens the file in its own place; what cannot be opened is said, and the path stays to be mended."""

    SCOPE = Scope.OPENING
    CSS_PATH: ClassVar = ["window.tcss", "open_file.tcss"]
    BINDINGS: ClassVar[list[BindingType]] = [*bindings_of(Scope.OPENING)]

    def __init__(self, charset: Charset) -> None:
        super().__init__()
        self._charset = charset

    def compose(self) -> ComposeResult:
        """Lay out the question."""
        with Container(classes="window") as window:
            window.border_title = "Open a file of your own"
            yield Static(
                "A program is run: a node (.py) or a launch file. "
                "A recording (.mcap) is shown, and nothing in it is run.",
                markup=False,
            )
            yield PathInput()
            yield Static(id="said", markup=False)
            yield KeyBar(Scope.OPENING, self._charset)

    def action_go(self) -> None:
        """Open what was typed."""
        self._open(self.query_one(PathInput).value)

    def action_complete(self) -> None:
        """Complete the path up to the cursor, and list what it could go on with."""
        typed = self.query_one(PathInput)
        place = typed.cursor_position
        text, names = completed(typed.value[:place])
        if text != typed.value[:place]:
            typed.value = text + typed.value[place:]
            typed.cursor_position = len(text)
        shown = [visible(name, self._charset) for name in names[:_MOST_NAMES]]
        more = f"… {len(names) - _MOST_NAMES} more" if len(names) > _MOST_NAMES else ""
        self._say("  ".join([*shown, more]) if len(names) != 1 else "", wrong=not names)
        if not names:
            self._say("No folder, program or recording begins like that.", wrong=True)

    def action_close(self) -> None:
        """Open nothing."""
        self.dismiss()

    @on(Input.Submitted)
    def _submit(self, event: Input.Submitted) -> None:
        event.stop()
        self._open(event.value)

    def _open(self, text: str) -> None:
        try:
            console_of(self).open_file(entry_for(text, time()))
        except CannotOpenError as error:
            self._say(visible(str(error), self._charset), wrong=True)

    def _say(self, text: str, *, wrong: bool) -> None:
        said = self.query_one("#said", Static)
        said.set_class(wrong, "wrong")
        said.update(text)
