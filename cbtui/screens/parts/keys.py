"""The keys that a run's screen offers, by the state of its parts and by the focus."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from textual.widget import Widget

from cbtui.keys.action import KeyAction, Scope
from cbtui.looks.theme import Charset
from cbtui.screens.layout import Layout
from cbtui.screens.parts.part import ScreenParts
from cbtui.screens.sized import SizedScreen
from cbtui.widgets.checks import ChecksView
from cbtui.widgets.code import CodeView
from cbtui.widgets.key_bar import KeyBar, hint
from cbtui.widgets.lanes import Lanes
from cbtui.widgets.log import LogFilter, LogLines
from cbtui.widgets.shell import ProgramKeyboard, Prompt

_ON_LANES = ("zoom", "pan", "select", "lane", "event", "code", "copy", "deselect")
"""Labels of the actions that the lanes' frame shows."""

_WITH_KEYS = (LogLines, CodeView, ChecksView)
"""Panes with a ``check_action`` of their own."""

_TYPED_INTO = (Prompt, ProgramKeyboard, LogFilter)
_NOT_ON: Mapping[str, tuple[type[Widget], ...]] = {
    "pan_earlier": _TYPED_INTO,
    "pan_later": _TYPED_INTO,
    "select": _TYPED_INTO,
    "next_pane": _TYPED_INTO,
    "copy_details": (*_TYPED_INTO, LogLines, CodeView),
    "filter_log": (LogLines,),
    "open_source": (CodeView,),
}
"""Widgets that use an action's keys otherwise while they have the focus."""

_SCOPES: Mapping[type[Widget], Scope] = {
    Prompt: Scope.PROMPT,
    ProgramKeyboard: Scope.KEYBOARD,
    LogLines: Scope.LOG,
    LogFilter: Scope.FILTER,
    CodeView: Scope.CODE,
    ChecksView: Scope.CHECKS,
}
"""The scope whose keys are shown while a widget has the focus."""


@dataclass
class OfferedKeys:
    """Tells which actions are available, and shows their keys."""

    screen: SizedScreen[Any]
    parts: ScreenParts
    charset: Charset
    _shown: tuple[KeyAction, ...] = ()

    def offer(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Tell whether an action is available now."""
        focused = self.screen.focused
        if isinstance(focused, _WITH_KEYS) and not focused.check_action(action, parameters):
            return False
        if isinstance(focused, _NOT_ON.get(action, ())):
            return False
        if action in ("submit", "interrupt"):
            return not (isinstance(focused, ProgramKeyboard) and focused.reads.takes_keys)
        return self.parts.offer(action, parameters)

    def show(self) -> None:
        """Update the key bar and the lanes' frame if other actions are available."""
        lanes, bar = self.screen.query_one(Lanes), self.screen.query_one(KeyBar)
        # In the grid the lanes have a frame, which shows their keys.
        framed = self.screen.layout_now is Layout.GRID
        bar.first = (*_ON_LANES, "enlarge") if lanes.has_focus and not framed else ()
        working = tuple(bar.working())
        if working != self._shown:
            self._shown = working
            bar.changed()
        lanes.hint = hint([action for action in working if action.label in _ON_LANES], self.charset)

    def follow_focus(self) -> None:
        """Show the keys of the widget with the focus."""
        focused = self.screen.focused
        scopes = (scope for kind, scope in _SCOPES.items() if isinstance(focused, kind))
        self.screen.query_one(KeyBar).show(next(scopes, Scope.LESSON))
