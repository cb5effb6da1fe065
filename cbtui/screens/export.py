"""Asks in which format a run is to be exported."""

from typing import ClassVar, NamedTuple

from textual import on
from textual.app import ComposeResult
from textual.binding import BindingType
from textual.containers import Container
from textual.content import Content
from textual.widgets import OptionList, Static
from textual.widgets.option_list import Option

from cbtui.keys.action import Scope
from cbtui.keys.bindings import bindings_of
from cbtui.keys.keymap import keymap_of
from cbtui.looks.theme import Charset
from cbtui.screens.sized import SizedModal
from cbtui.widgets.key_bar import KeyBar
from cbtui.widgets.pageable_option_list import PageableOptionList


class ExportChoice(NamedTuple):
    """A format of ``exporting.FORMATS``, and whether it is to be of the stretch on screen only."""

    form: str
    on_screen: bool = False


CHOICES = {
    "picture": (ExportChoice("svg", on_screen=True), "picture", "the lanes as on screen, for paper (SVG)"),
    "whole": (ExportChoice("svg"), "whole picture", "the lanes of the whole run (SVG)"),
    "report": (ExportChoice("markdown"), "report", "set-up, statistics, waits, notices (Markdown)"),
    "table": (ExportChoice("csv"), "table", "a line for each call, for spreadsheets (CSV)"),
    "perfetto": (ExportChoice("perfetto"), "Perfetto", "a trace for ui.perfetto.dev"),
    "chrome": (ExportChoice("chrome"), "Chrome", "a trace for chrome://tracing and Speedscope"),
}
"""What can be chosen, by the names that the registry's actions have, with a name and a meaning."""


class ExportScreen(SizedModal[ExportChoice]):
    """Gives what was chosen; None if the person thinks better of it."""

    SCOPE = Scope.EXPORT
    CSS_PATH = "window.tcss"
    BINDINGS: ClassVar[list[BindingType]] = [*bindings_of(Scope.EXPORT)]

    def __init__(self, charset: Charset) -> None:
        super().__init__()
        self._charset = charset

    def compose(self) -> ComposeResult:
        """Lay out the question."""
        with Container(classes="window") as window:
            window.border_title = "Export"
            yield Static("What is to be made of the run so far?\nThe file comes into the current folder.")
            yield PageableOptionList(*(self._option(name) for name in CHOICES))
            yield KeyBar(Scope.EXPORT, self._charset)

    def on_mount(self) -> None:
        """Highlight the first."""
        self.query_one(OptionList).highlighted = 0

    @on(OptionList.OptionSelected)
    def _take(self, event: OptionList.OptionSelected) -> None:
        self.action_choose(list(CHOICES)[event.option_index])

    def action_choose(self, name: str) -> None:
        """Take one."""
        self.dismiss(CHOICES[name][0])

    def action_close(self) -> None:
        """Export nothing."""
        self.dismiss(None)

    def _option(self, name: str) -> Option:
        key = keymap_of(self.app).sign(Scope.EXPORT, f"choose({name!r})", self._charset)
        _, title, meaning = CHOICES[name]
        words = (key, "bold $text-accent"), f"  {title:<15}", (meaning, "$text-muted")
        return Option(Content.assemble(*words))
