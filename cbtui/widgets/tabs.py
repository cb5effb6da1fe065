"""The tabs of a layout that shows one pane at a time."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial

from rich.cells import cell_len
from textual.events import Click
from textual.geometry import Offset, Size
from textual.message import Message
from textual.reactive import reactive

from cbtui.keys.action import PANES
from cbtui.looks.theme import Charset, Ink, Role, TextRun
from cbtui.text.cells import fit
from cbtui.widgets.jump import JumpTarget
from cbtui.widgets.painted_widget import PaintedWidget, painted

_LINE = Ink(Role.FAINT)
_NOTE = Ink(Role.TEXT)
_SEPARATOR = " · "


class Tabs(PaintedWidget):
    """Shows the panes with their numbers, the current one in brackets."""

    def __init__(self, panes: Sequence[str]) -> None:
        super().__init__()
        self._panes = panes

    has_scene: reactive[bool] = painted(False)
    """Whether a scene takes the robot's place."""
    current: reactive[str] = painted(PANES[0])
    empty: reactive[str] = painted("")
    """A pane without content, which has a tab only while it is the current one."""
    note: reactive[str] = painted("")
    """The current pane's note at the right, its most important part first."""

    @dataclass
    class TabPicked(Message):
        """A pane was clicked."""

        pane: str

    def rows(self, size: Size) -> Sequence[Sequence[TextRun]]:
        """Paint the line."""
        runs = [TextRun("─", _LINE)]
        for pane, text in self._labels():
            shown = pane == self.current
            runs.append(TextRun(text, Ink(Role.STRONG if shown else Role.TEXT)))
        room = max(0, size.width - sum(len(run.text) for run in runs))
        note = _shortened_note(self.note, room - 2)
        return [[*runs, TextRun("─" * (room - cell_len(note)), _LINE), TextRun(note, _NOTE)]]

    def on_click(self, event: Click) -> None:
        """Post the clicked pane."""
        for start, pane, text in self._placed():
            if start <= event.x < start + len(text):
                self.post_message(self.TabPicked(pane))

    def jump_targets(self) -> Iterator[JumpTarget]:
        """Yield the tabs."""
        for start, pane, _ in self._placed():
            yield JumpTarget(Offset(start + 1, 0), partial(self.post_message, self.TabPicked(pane)), True)

    def _placed(self) -> Iterator[tuple[int, str, str]]:
        start = 1
        for pane, text in self._labels():
            yield start, pane, text
            start += len(text)

    def _labels(self) -> Iterator[tuple[str, str]]:
        for pane in self._panes:
            if pane == self.empty != self.current:
                continue
            title = title_of(pane, self.has_scene)
            yield pane, f"[{title}]" if pane == self.current else f" {title} "


def _shortened_note(note: str, room: int) -> str:
    """Return as many parts of a note as fit, the first one cut if need be."""
    parts = note.split(_SEPARATOR)
    while len(parts) > 1 and cell_len(_SEPARATOR.join(parts)) > room:
        parts.pop()
    text = _SEPARATOR.join(parts)
    return f" {fit(text, min(cell_len(text), room), Charset.BRAILLE)} " if text and room > 0 else ""


def title_of(pane: str, has_scene: bool = False) -> str:
    """Return a pane's number and name; with ``has_scene`` a scene takes the robot's place."""
    number = PANES.index(pane) if pane in PANES else len(PANES)
    return f"{number + 1} {'Scene' if has_scene and pane == 'robot' else pane.capitalize()}"
