"""The keys that a run's screen offers, by what its parts can do now and what has the focus."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from textual.widget import Widget

from cbtui.keys.action import Action, Scope
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
"""Labels of the actions that the lanes tell of themselves."""

_WITH_KEYS = (LogLines, CodeView, ChecksView)
"""Panes that know which of their own actions have a meaning."""

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
"""Widgets that make something else of an action's keys while they have the focus."""

_SCOPES: Mapping[type[Widget], Scope] = {
    Prompt: Scope.PROMPT,
    ProgramKeyboard: Scope.KEYBOARD,
    LogLines: Scope.LOG,
    LogFilter: Scope.FILTER,
    CodeView: Scope.CODE,
    ChecksView: Scope.CHECKS,
}
"""Whose keys are told of while it has the focus."""


@dataclass
class OfferedKeys:
    """Tells which actions have a meaning now, and shows their keys."""

    screen: SizedScreen[Any]
    parts: ScreenParts
    charset: Charset
    _shown: tuple[Action, ...] = ()

    def offer(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Tell whether an action has a meaning now."""
        focused = self.screen.focused
        if isinstance(focused, _WITH_KEYS) and not focused.check_action(action, parameters):
            return False
        if isinstance(focused, _NOT_ON.get(action, ())):
            return False
        if action in ("submit", "interrupt"):
            return not (isinstance(focused, ProgramKeyboard) and focused.reads.takes_keys)
        return self.parts.offer(action, parameters)

    def show(self) -> None:
        """Tell the line of keys when others have a meaning, and the lanes of theirs."""
        lanes, bar = self.screen.query_one(Lanes), self.screen.query_one(KeyBar)
        # Where the lanes have a frame, that tells of them.
        framed = self.screen.layout_now is Layout.GRID
        bar.first = (*_ON_LANES, "enlarge") if lanes.has_focus and not framed else ()
        working = tuple(bar.working())
        if working != self._shown:
            self._shown = working
            bar.changed()
        lanes.hint = hint([action for action in working if action.label in _ON_LANES], self.charset)

    def follow_focus(self) -> None:
        """Show the keys of what has the focus now."""
        focused = self.screen.focused
        scopes = (scope for kind, scope in _SCOPES.items() if isinstance(focused, kind))
        self.screen.query_one(KeyBar).show(next(scopes, Scope.LESSON))
