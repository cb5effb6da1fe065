"""The help: every key and what it does, from the registry."""

from collections.abc import Iterator, Sequence

from textual.app import ComposeResult
from textual.containers import VerticalScroll
from textual.content import Content
from textual.widgets import Static

from cbtui.keys.action import KeyAction, Scope, group_by
from cbtui.keys.actions import ACTIONS
from cbtui.keys.keymap import Keymap, keymap_of
from cbtui.keys.signs import signs_of
from cbtui.looks.theme import Charset
from cbtui.screens.window import WindowScreen

_SHOWN = (
    Scope.LESSON,
    Scope.CHECKS,
    Scope.CODE,
    Scope.LOG,
    Scope.FILTER,
    Scope.PROMPT,
    Scope.KEYBOARD,
    Scope.COMPARE,
    Scope.MENU,
    Scope.SEARCH,
    Scope.OPENING,
    Scope.EVERYWHERE,
)


class HelpScreen(WindowScreen[None]):
    """Lists the keys of all screens."""

    SCOPE = Scope.HELP
    heading = "Keys"

    def __init__(self, charset: Charset) -> None:
        super().__init__(charset)

    def content(self) -> ComposeResult:
        """Lay out the list."""
        with VerticalScroll():
            keymap = keymap_of(self.app)
            yield Static(Content("\n").join(_sections(self._scope_below, keymap, self._charset)))

    @property
    def _scope_below(self) -> Scope | None:
        """The scope of the screen below, which is listed first."""
        scope: Scope | None = getattr(self.app.screen_stack[-2], "SCOPE", None)
        return scope


def _sections(first: Scope | None, keymap: Keymap, charset: Charset) -> Iterator[Content]:
    for scope in sorted(_SHOWN, key=lambda scope: scope is not first):
        actions = keymap.of(action for action in ACTIONS if action.scope is scope)
        rows = [_row(group, charset) for group in group_by(actions, "line")]
        yield Content("\n").join([Content.styled(scope.value, "bold $text-primary"), *rows, Content("")])


def _row(actions: Sequence[KeyAction], charset: Charset) -> Content:
    keys = signs_of(actions, charset)
    return Content.assemble((f"{keys:>7}", "bold $text-accent"), f"  {actions[0].line}")
