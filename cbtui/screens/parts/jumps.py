"""Jumping: each pane, lane, bar and row that can be picked gets a letter."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from string import ascii_uppercase

from textual.geometry import Offset
from textual.screen import Screen
from textual.widget import Widget

from cbtui.screens.parts.panes import PaneLayout
from cbtui.screens.parts.part import ScreenPart, WindowHost
from cbtui.screens.windows.jump import JumpScreen
from cbtui.widgets.jump import Jumpable, JumpTarget
from cbtui.widgets.tabs import Tabs

_LETTERS = "asdfghjklqwertyuiopzxcvbnm" + ascii_uppercase
"""The easiest keys first; further places have no letter."""


@dataclass
class Jumps(ScreenPart):
    """Shows letters on the places of the screen, and goes to the place of the typed letter."""

    screen: Screen[None]
    host: WindowHost
    panes: PaneLayout | None = None

    def action_jump(self) -> None:
        """Show the letters."""
        found = dict(zip(_LETTERS, self._places(), strict=False))

        def go(letter: str | None) -> None:
            if letter is not None:
                found[letter].go()

        self.host.ask(JumpScreen(found, self.host.charset), go)

    def _places(self) -> Iterator[JumpTarget]:
        """Yield the places, counted from the top left of the screen, the panes first."""
        if self.panes is not None:
            yield from _framed(self.panes)
        for widget in sorted(self.screen.query("*"), key=lambda each: not isinstance(each, Tabs)):
            if isinstance(widget, Jumpable) and widget.region:
                for target in widget.jump_targets():
                    place = widget.content_region.offset + target.place
                    yield target._replace(place=place, go=partial(_go, widget, target.go))


def _framed(panes: PaneLayout) -> Iterator[JumpTarget]:
    """Yield the panes that have a frame to hold a letter."""
    for name in panes.names:
        pane = panes.pane(name)
        if pane.styles.border_top[0] and pane.size:
            yield JumpTarget(pane.region.offset + Offset(1, 0), partial(panes.show, name))


def _go(widget: Widget, go: Callable[[], object]) -> None:
    if widget.focusable:
        widget.focus()
    go()
