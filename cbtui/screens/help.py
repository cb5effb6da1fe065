"""Every key and what it does, from the registry."""

from collections.abc import Iterator, Sequence
from typing import ClassVar

from textual.app import ComposeResult
from textual.binding import BindingType
from textual.containers import Container, VerticalScroll
from textual.content import Content
from textual.widgets import Static

from cbtui.keys.action import Action, Scope, group_by
from cbtui.keys.actions import ACTIONS
from cbtui.keys.bindings import bindings_of
from cbtui.keys.keymap import Keymap, keymap_of
from cbtui.keys.signs import signs_of
from cbtui.looks.theme import Charset
from cbtui.screens.sized import SizedModal
from cbtui.widgets.key_bar import KeyBar

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


class HelpScreen(SizedModal[None]):
    """Lists the keys of all screens."""

    SCOPE = Scope.HELP
    CSS_PATH = "window.tcss"
    BINDINGS: ClassVar[list[BindingType]] = [*bindings_of(Scope.HELP)]

    def __init__(self, charset: Charset) -> None:
        super().__init__()
        self._charset = charset

    def compose(self) -> ComposeResult:
        """Lay out the list."""
        with Container(classes="window") as window:
            window.border_title = "Keys"
            with VerticalScroll():
                keymap = keymap_of(self.app)
                yield Static(Content("\n").join(_sections(self._scope_below, keymap, self._charset)))
            yield KeyBar(Scope.HELP, self._charset)

    @property
    def _scope_below(self) -> Scope | None:
        """What the person looked at when they asked for help; that comes first."""
        scope: Scope | None = getattr(self.app.screen_stack[-2], "SCOPE", None)
        return scope

    def action_close(self) -> None:
        """Go back."""
        self.dismiss()


def _sections(first: Scope | None, keymap: Keymap, charset: Charset) -> Iterator[Content]:
    for scope in sorted(_SHOWN, key=lambda scope: scope is not first):
        actions = keymap.of(action for action in ACTIONS if action.scope is scope)
        rows = [_row(group, charset) for group in group_by(actions, "line")]
        yield Content("\n").join([Content.styled(scope.value, "bold $text-primary"), *rows, Content("")])


def _row(actions: Sequence[Action], charset: Charset) -> Content:
    keys = signs_of(actions, charset)
    return Content.assemble((f"{keys:>7}", "bold $text-accent"), f"  {actions[0].line}")
