"""Actions as Textual bindings, and the node that performs each of them."""

from typing import TYPE_CHECKING, Any

from textual.binding import Binding

from cbtui.keys.action import KeyAction, Scope, key_id
from cbtui.keys.actions import ACTIONS

if TYPE_CHECKING:
    from textual.app import App

_KEYS_THAT_WIDGETS_WANT = {"left", "right", "tab", "ctrl+c"}
"""Keys that panes bind to scrolling and focus: the screen's bindings need priority."""

_PLACES = {
    Scope.EVERYWHERE: "app",
    Scope.SEARCH: "focused",
    Scope.LOG: "focused",
    Scope.FILTER: "focused",
    Scope.CODE: "focused",
    Scope.CHECKS: "focused",
    Scope.CHOICE: "focused",
    Scope.PROMPT: "focused",
    Scope.KEYBOARD: "focused",
}
"""The node that implements the actions of a scope, if it is not the screen."""


def bindings_of(*scopes: Scope) -> list[Binding]:
    """Return the key bindings of the actions that belong to exactly these scopes."""
    return [_binding(action) for action in ACTIONS if action.scope in scopes]


def of_the_app(name: str) -> Binding:
    """Return the key binding of the app's action of that name, for a window: it hides those of the app."""
    [action] = (each for each in ACTIONS if (each.scope, each.id) == (Scope.EVERYWHERE, name))
    return _binding(action._replace(id=f"app.{name}"), key_id(action))


async def perform(app: "App[Any]", action: KeyAction) -> None:
    """Perform an action for a click or the palette; one of the widget with the focus only if there is one."""
    place = _PLACES.get(action.scope, "screen")
    if place != "focused" or app.focused is not None:
        await app.run_action(f"{place}.{action.id}")


def _binding(action: KeyAction, name: str = "") -> Binding:
    return Binding(
        action.key,
        action.id,
        action.label,
        tooltip=action.help,
        id=name or key_id(action),
        priority=action.key in _KEYS_THAT_WIDGETS_WANT,
    )
