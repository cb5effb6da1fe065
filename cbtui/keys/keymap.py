"""The key map: the registry's keys, and those that the user has remapped."""

from collections.abc import Iterable, Mapping
from types import MappingProxyType
from typing import Any

from textual.app import App

from cbtui.keys.action import KeyAction, Scope, key_id
from cbtui.keys.actions import ACTIONS
from cbtui.keys.signs import character_of, signs_of
from cbtui.looks.theme import Charset


class Keymap:
    """The keys in force; ``chosen`` has remapped keys by the key id of their action.

    Keys are Textual's names, or characters.
    """

    def __init__(self, chosen: Mapping[str, tuple[str, ...]] = MappingProxyType({})) -> None:
        self._chosen = dict(chosen)

    def of(self, actions: Iterable[KeyAction]) -> list[KeyAction]:
        """Return the actions with their keys in force."""
        return [self._with_its_keys(action) for action in actions] if self._chosen else list(actions)

    def sign(self, scope: Scope, action_id: str, charset: Charset) -> str:
        """Return the key of one action as people write it."""
        return signs_of(
            self.of(action for action in ACTIONS if (action.scope, action.id) == (scope, action_id)), charset
        )

    def on(self, key: str, *scopes: Scope) -> list[KeyAction]:
        """Return the actions of some scopes that have a key in force, in the order of the scopes."""
        actions = self.of(action for scope in scopes for action in ACTIONS if action.scope is scope)
        return [action for action in actions if not action.refused and canonical(key) in keys_of(action)]

    def for_textual(self) -> dict[str, str]:
        """Return the argument for ``App.set_keymap``.

        Remapping one action removes its old key from all actions in Textual, so the actions that share that
        key are listed with it.
        """
        moved = {
            (action.scope, key)
            for action in ACTIONS
            if key_id(action) in self._chosen
            for key in keys_of(action)
        }
        remapped = [
            action
            for action in ACTIONS
            if key_id(action) in self._chosen or any((action.scope, key) in moved for key in keys_of(action))
        ]
        return {key_id(action): action.key for action in self.of(remapped)}

    def _with_its_keys(self, action: KeyAction) -> KeyAction:
        chosen = self._chosen.get(key_id(action._replace(id=action.refused or action.id)))
        return action if chosen is None else action._replace(key=",".join(map(_name, chosen)))


STANDARD = Keymap()


def keymap_of(app: App[Any]) -> Keymap:
    """Return the keys in force in an app: its ``keys`` attribute, or the registry's keys."""
    keymap = getattr(app, "keys", STANDARD)
    assert isinstance(keymap, Keymap)
    return keymap


def keys_of(action: KeyAction) -> tuple[str, ...]:
    """Return an action's keys in canonical form."""
    return tuple(canonical(key) for key in action.key.split(","))


def canonical(key: str) -> str:
    """Return the canonical form of a key: ``?`` for ``question_mark``."""
    return character_of(key) or key


def is_typed(key: str) -> bool:
    """Tell whether a key edits a line of text or moves its cursor."""
    return len(key) == 1 or key in {"space", "backspace", "delete", "left", "right", "home", "end"}


def _name(key: str) -> str:
    return "comma" if key == "," else key
