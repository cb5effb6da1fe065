"""The window that asks for an export format."""

from typing import NamedTuple

from textual import on
from textual.app import ComposeResult
from textual.widgets import OptionList, Static

from cbtui.keys.action import Scope
from cbtui.screens.windows.window import WindowScreen
from cbtui.widgets.pageable_option_list import PageableOptionList


class ExportChoice(NamedTuple):
    """A format of ``exporting.FORMATS``, for the window on screen or for the whole run."""

    form: str
    on_screen: bool = False


CHOICES = {
    "picture": (ExportChoice("svg", on_screen=True), "picture", "the lanes as on screen, for paper (SVG)"),
    "whole": (ExportChoice("svg"), "whole picture", "the lanes of the whole run (SVG)"),
    "report": (ExportChoice("markdown"), "report", "set-up, statistics, waits, notices (Markdown)"),
    "html": (ExportChoice("html"), "page", "plays the run in any browser (HTML)"),
    "table": (ExportChoice("csv"), "table", "a line for each call, for spreadsheets (CSV)"),
    "perfetto": (ExportChoice("perfetto"), "Perfetto", "a trace for ui.perfetto.dev"),
    "chrome": (ExportChoice("chrome"), "Chrome", "a trace for chrome://tracing and Speedscope"),
}
"""The choices by their names in the registry's actions, with a title and a description."""


class ExportScreen(WindowScreen[ExportChoice]):
    """Its result is the choice; None if it was closed."""

    SCOPE = Scope.EXPORT
    heading = "Export"

    def content(self) -> ComposeResult:
        """Lay out the question."""
        yield Static("Export the run so far as what?\nThe file goes to the current folder.")
        yield PageableOptionList(
            *(
                self.option(name, f"  {title:<15}", (meaning, "$text-muted"))
                for name, (_, title, meaning) in CHOICES.items()
            )
        )

    def on_mount(self) -> None:
        """Highlight the first."""
        self.query_one(OptionList).highlighted = 0

    @on(OptionList.OptionSelected)
    def _take(self, event: OptionList.OptionSelected) -> None:
        self.action_choose(list(CHOICES)[event.option_index])

    def action_choose(self, name: str) -> None:
        """Take one."""
        self.dismiss(CHOICES[name][0])
