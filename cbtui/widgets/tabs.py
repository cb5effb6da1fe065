"""The line of panes where only one of them has room."""

from collections.abc import Iterator, Sequence

from textual.events import Click
from textual.geometry import Size
from textual.message import Message
from textual.reactive import reactive

from cbtui.actions import PANES
from cbtui.theme import Ink, Role, Run
from cbtui.widgets.painted import Painted

_LINE = Ink(Role.FAINT)


class Tabs(Painted):
    """Names the panes with their numbers, the one that is shown in brackets."""

    current: reactive[str] = reactive(PANES[0])

    class Picked(Message):
        """A pane was clicked."""

        def __init__(self, pane: str) -> None:
            super().__init__()
            self.pane = pane

    def rows(self, size: Size) -> Sequence[Sequence[Run]]:
        """Paint the line."""
        runs = [Run("─", _LINE)]
        for pane, text in _labels(self.current):
            shown = pane == self.current
            runs.append(Run(text, Ink(Role.STRONG if shown else Role.TEXT)))
        taken = sum(len(run.text) for run in runs)
        return [[*runs, Run("─" * (size.width - taken), _LINE)]]

    def watch_current(self) -> None:
        """Show another one in brackets."""
        self.changed()

    def on_click(self, event: Click) -> None:
        """Tell which pane was clicked."""
        start = 1
        for pane, text in _labels(self.current):
            if start <= event.x < start + len(text):
                self.post_message(self.Picked(pane))
            start += len(text)


def title_of(pane: str) -> str:
    """Return a pane's number and name."""
    return f"{PANES.index(pane) + 1} {pane.capitalize()}"


def _labels(current: str) -> Iterator[tuple[str, str]]:
    for pane in PANES:
        yield pane, f"[{title_of(pane)}]" if pane == current else f" {title_of(pane)} "
