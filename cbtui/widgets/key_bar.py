"""The key bar at the bottom: the available actions' keys, as many as fit."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from textual.events import Click
from textual.geometry import Size
from textual.reactive import reactive
from textual.screen import Screen

from cbtui.keys.action import KeyAction, Scope, group_by, method_of
from cbtui.keys.actions import actions_of
from cbtui.keys.bindings import perform
from cbtui.keys.keymap import keymap_of, keys_of
from cbtui.keys.signs import signs_of
from cbtui.looks.theme import GLYPHS, Charset, Ink, Role, TextRun
from cbtui.terminal.textual_internals import paint_now
from cbtui.text.cells import fit
from cbtui.widgets.painted_widget import PaintedWidget, painted

_KEY = Ink(Role.STRONG)
_LABEL = Ink(Role.FAINT)
_GAP = "  "
_ALWAYS = ("leave", "go_back", "leave_prompt", "close", "help")


@dataclass(frozen=True, slots=True)
class KeyBarEntry:
    """Keys that share a label."""

    keys: str
    label: str
    actions: tuple[KeyAction, ...]

    @property
    def width(self) -> int:
        """Its columns, with the gap before the next entry."""
        return len(self.keys) + 1 + len(self.label) + len(_GAP)


class KeyBar(PaintedWidget):
    """Shows the keys of a scope; a click performs the action. Call ``changed`` when others are available.

    ``first`` are labels of actions that come first, in that order; ``offered`` those shown, if they are set.
    """

    first: Sequence[str] = ()
    offered: reactive[tuple[KeyAction, ...]] = painted(())

    def __init__(self, scope: Scope, charset: Charset) -> None:
        super().__init__()
        self.scope = scope
        """The place whose keys it shows."""
        self._charset = charset

    def show(self, scope: Scope) -> None:
        """Show the keys of another scope."""
        self.scope, self.offered = scope, ()
        self.changed()

    def working(self) -> list[KeyAction]:
        """Return the available actions with the keys in force."""
        working = [action for action in actions_of(self.scope) if action.label and self._works(action)]
        places = {label: place for place, label in enumerate(self.first)}
        working.sort(key=lambda action: places.get(action.label, len(places)))
        return keymap_of(self.app).of(working)

    def in_force(self) -> dict[str, KeyAction]:
        """Return the action that each key performs now; a pane's comes before the screen's."""
        here = keymap_of(self.app).of(filter(self._works, actions_of(self.scope)))
        return {key: action for action in reversed(here) for key in keys_of(action)}

    def say(self, words: str) -> None:
        """Show words instead of the keys, at once, until the current message has been handled."""
        self.show_rows([[TextRun(fit(f" {words}", self.size.width, self._charset), _KEY)]])
        paint_now(self)
        self.changed()

    def rows(self, size: Size) -> Sequence[Sequence[TextRun]]:
        """Paint the keys."""
        return [key_row(self._entries(size.width), size.width)]

    async def on_click(self, event: Click) -> None:
        """Perform the action of the key under the mouse; of several keys, the nearest.

        The second of two quick clicks would reach another screen, and is ignored.
        """
        if not self.screen.is_active:
            return
        start = 1
        for entry in self._entries(self.size.width):
            if start <= event.x < start + entry.width:
                place = max(0, (event.x - start) * len(entry.actions) // max(1, len(entry.keys)))
                await perform(self.app, entry.actions[min(place, len(entry.actions) - 1)])
                return
            start += entry.width

    def _entries(self, width: int) -> list[KeyBarEntry]:
        return fitting_entries(key_bar_entries(self.offered or self.working(), self._charset), width - 1)

    def _works(self, action: KeyAction) -> bool:
        return self.screen.check_action(*method_of(action)) is not False


def say_at_once(screen: Screen[Any], words: str) -> None:
    """Show words instead of a screen's keys, before a key's action that takes long."""
    for bar in screen.query(KeyBar):
        bar.say(words)


def key_bar_entries(actions: Iterable[KeyAction], charset: Charset) -> list[KeyBarEntry]:
    """Return the entries of some actions."""
    return [
        KeyBarEntry(signs_of(group, charset), group[0].label, group) for group in group_by(actions, "label")
    ]


def hint(actions: Iterable[KeyAction], charset: Charset) -> str:
    """Return the keys of some actions for a widget's frame: ``zoom < >``, separated by dots."""
    between = f" {GLYPHS[charset].between} "
    return between.join(f"{entry.label} {entry.keys}" for entry in key_bar_entries(actions, charset))


def key_row(shown: Iterable[KeyBarEntry], width: int) -> list[TextRun]:
    """Return the line of the entries in exactly ``width`` columns."""
    runs: list[TextRun] = []
    for entry in shown:
        runs += [
            TextRun(" " if not runs else _GAP, _LABEL),
            TextRun(entry.keys, _KEY),
            TextRun(f" {entry.label}", _LABEL),
        ]
    taken = sum(len(run.text) for run in runs)
    return [*runs, TextRun(" " * (width - taken), _LABEL)]


def fitting_entries(every: list[KeyBarEntry], width: int) -> list[KeyBarEntry]:
    """Return the entries that fit: leaving and help always, then the first ones."""
    last = [entry for entry in every if entry.actions[0].id in _ALWAYS]
    room = width - sum(entry.width for entry in last) + len(_GAP)
    chosen = []
    for entry in every:
        if entry in last:
            chosen.append(entry)
        elif entry.width <= room:
            room -= entry.width
            chosen.append(entry)
        else:
            room = 0
    return chosen
