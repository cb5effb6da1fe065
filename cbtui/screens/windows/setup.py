"""The window with all changeable settings of a run, and the equivalent code."""

from collections.abc import Callable
from functools import partial
from typing import Any

from textual import on
from textual.app import ComposeResult
from textual.containers import VerticalScroll
from textual.content import Content
from textual.widgets import OptionList, Static
from textual.widgets.option_list import Option

from cbtui.keys.action import Scope
from cbtui.looks.theme import Charset
from cbtui.runs.setup.changeable import ChangeableSetup
from cbtui.runs.setup.changes import Changes
from cbtui.runs.setup.equivalent_code import code_of, edits_of
from cbtui.screens.windows.setup_rows import SettingRow, rows_of
from cbtui.screens.windows.window import WindowScreen
from cbtui.text.cells import fit, visible
from cbtui.widgets.key_bar import KeyBar
from cbtui.widgets.pageable_option_list import PageableOptionList

_COLUMNS = (19, 7, 30, 12)
"""Column widths: subject, aspect, value in this run, changed value."""


class SetupScreen(WindowScreen[Changes]):
    """Its result is the changes to restart the run with; None if it was closed.

    ``first`` selects the row that is highlighted first.
    """

    SCOPE = Scope.SETUP
    heading = "Set-up"

    def __init__(
        self, about: ChangeableSetup, changes: Changes, first: Callable[[SettingRow], bool], charset: Charset
    ) -> None:
        super().__init__(charset)
        self._about = about
        self._changes = changes
        self._unchanged = Changes(real=changes.real, whole_tracebacks=changes.whole_tracebacks)
        self._rows = rows_of(about)
        self._first = first

    def content(self) -> ComposeResult:
        """Lay out the rows, and the code of what is changed."""
        yield Static(Content.styled(self._line("", "", "in this run", "changed to"), "$text-muted"))
        yield PageableOptionList()
        with VerticalScroll(can_focus=False):
            yield Static(classes="code")

    def on_mount(self) -> None:
        """Highlight the row that was asked for."""
        self._show()
        wanted = (place for place, row in enumerate(self._rows) if self._first(row))
        self.query_one(OptionList).highlighted = next(wanted, 0)

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Offer ``undo_all`` if there are changes."""
        return action != "undo_all" or self._changes != self._unchanged

    @on(OptionList.OptionSelected)
    def _ask(self, event: OptionList.OptionSelected) -> None:
        row = self._rows[event.option_index]
        self.app.push_screen(row.ask(self._changes, self._charset), partial(self._take, row))

    def _take(self, row: SettingRow, answer: Any) -> None:
        if answer is not None:
            self._changes = row.take(self._changes, answer)
            self._show()

    def action_change(self) -> None:
        """Ask for what is highlighted."""
        self.query_one(OptionList).action_select()

    def action_undo_all(self) -> None:
        """Discard all changes, except what the program runs on."""
        self._changes = self._unchanged
        self._show()

    def action_run(self) -> None:
        """Run again with what is chosen."""
        self.dismiss(self._changes)

    def _show(self) -> None:
        rows = self.query_one(OptionList)
        place = rows.highlighted
        rows.set_options([self._option(row) for row in self._rows])
        rows.highlighted = place
        code = [*code_of(self._changes, self._about), *edits_of(self._changes)] or ["# nothing is changed"]
        lines = (visible(line, self._charset) for each in code for line in each.splitlines())
        self.query_one(".code", Static).update(Content("\n".join(lines)))
        self.query_one(KeyBar).changed()

    def _option(self, row: SettingRow) -> Option:
        changed_to = row.changed_to(self._changes)
        line = self._line(row.what, row.aspect, row.now, changed_to)
        kept = len(line) - (_COLUMNS[-1] if changed_to else 0)
        text = Content.assemble(line[:kept], (line[kept:], "bold $text-accent"))
        return Option(text, disabled=row.is_fixed)

    def _line(self, *texts: str) -> str:
        """Lay out a row; a value that is not changed may take the room of the changed one."""
        *left, now, changed = _COLUMNS
        widths = _COLUMNS if texts[-1] else (*left, now + 1 + changed, 0)
        parts = (fit(text, width, self._charset) for text, width in zip(texts, widths, strict=True) if width)
        return " ".join(parts)
