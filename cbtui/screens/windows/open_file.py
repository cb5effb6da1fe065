"""The window that asks for a program or a recording to open."""

from time import time
from typing import ClassVar

from textual import on
from textual.app import ComposeResult
from textual.widgets import Input, Static

from cbtui.keys.action import Scope
from cbtui.runs.setup.own_files import CannotOpenError, completed, entry_for
from cbtui.screens.console import console_of
from cbtui.screens.windows.window import WindowScreen
from cbtui.text.cells import visible

_MOST_NAMES = 24
"""The most names that are listed."""


class PathInput(Input):
    """The input of the path; tab is left to the screen."""

    def __init__(self) -> None:
        super().__init__(placeholder="my_node.py", compact=True, select_on_focus=False)


class OpenFileScreen(WindowScreen[None]):
    """Opens a file in place of itself; on failure it shows why and stays open."""

    SCOPE = Scope.OPENING
    heading = "Open a file of your own"
    CSS_PATH: ClassVar = ["window.tcss", "open_file.tcss"]

    def content(self) -> ComposeResult:
        """Lay out the question."""
        yield Static(
            "A program is run: a node (.py) or a launch file. "
            "A recording (.mcap) is shown, and nothing in it is run.",
            markup=False,
        )
        yield PathInput()
        yield Static(id="said", markup=False)

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
