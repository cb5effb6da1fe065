"""The window that asks for an export format."""

from typing import NamedTuple

from textual.app import ComposeResult
from textual.widgets import Static

from cbtui.keys.action import Scope
from cbtui.screens.windows.window import ChoiceScreen
from cbtui.widgets.pageable_option_list import PageableOptionList


class ExportChoice(NamedTuple):
    """A format of ``exporting.FORMATS`` as a person chooses it, of the stretch on screen or the whole run."""

    form: str
    title: str
    meaning: str
    on_screen: bool = False


CHOICES = {
    "picture": ExportChoice("svg", "picture", "the lanes as on screen, for paper (SVG)", on_screen=True),
    "whole": ExportChoice("svg", "whole picture", "the lanes of the whole run (SVG)"),
    "report": ExportChoice("markdown", "report", "set-up, statistics, waits, notices (Markdown)"),
    "html": ExportChoice("html", "page", "plays the run in any browser (HTML)"),
    "table": ExportChoice("csv", "table", "a line for each call, for spreadsheets (CSV)"),
    "perfetto": ExportChoice("perfetto", "Perfetto", "a trace for ui.perfetto.dev"),
    "chrome": ExportChoice("chrome", "Chrome", "a trace for chrome://tracing and Speedscope"),
}
"""The choices by their names in the registry's actions."""


class ExportScreen(ChoiceScreen[str]):
    """Asks for one of ``CHOICES``; its result is the name, or None if the window was closed."""

    SCOPE = Scope.EXPORT
    heading = "Export"
    choices = tuple(CHOICES)
    highlighted = choices[0]

    def content(self) -> ComposeResult:
        """Lay out the question."""
        yield Static("Export the run so far as what?\nThe file goes to the current folder.")
        yield PageableOptionList(
            *(
                self.option(name, f"  {choice.title:<15}", (choice.meaning, "$text-muted"))
                for name, choice in CHOICES.items()
            )
        )
