"""Which keys do what: the registry's own, but for those that a person has chosen otherwise."""

from collections.abc import Iterable, Mapping
from types import MappingProxyType
from typing import Any

from textual.app import App

from cbtui.keys.action import Action, Scope, key_id
from cbtui.keys.actions import ACTIONS
from cbtui.keys.signs import character_of, signs_of
from cbtui.looks.theme import Charset


class Keymap:
    """The keys in force; ``chosen`` has, by an action's key id, the keys that it has instead of its own.

    Keys are Textual's names, or characters.
    """

    def __init__(self, chosen: Mapping[str, tuple[str, ...]] = MappingProxyType({})) -> None:
        self._chosen = dict(chosen)

    def of(self, actions: Iterable[Action]) -> list[Action]:
        """Return the actions with the keys that they have."""
        return [self._with_its_keys(action) for action in actions]

    def sign(self, scope: Scope, action_id: str, charset: Charset) -> str:
        """Return the key of one action as people write it."""
        return signs_of(
            self.of(action for action in ACTIONS if (action.scope, action.id) == (scope, action_id)), charset
        )

    def for_textual(self) -> dict[str, str]:
        """Return what ``App.set_keymap`` has to be told.

        Textual takes a key away from every action that has it when it takes it away from one, so those that
        share a key with an action that has another now are told to keep theirs.
        """
        moved = {
            (action.scope, key)
            for action in ACTIONS
            if key_id(action) in self._chosen
            for key in keys_of(action)
        }
        told = [
            action
            for action in ACTIONS
            if key_id(action) in self._chosen or any((action.scope, key) in moved for key in keys_of(action))
        ]
        return {key_id(action): action.key for action in self.of(told)}

    def _with_its_keys(self, action: Action) -> Action:
        chosen = self._chosen.get(key_id(action))
        return action if chosen is None else action._replace(key=",".join(map(_name, chosen)))


STANDARD = Keymap()


def keymap_of(app: App[Any]) -> Keymap:
    """Return the keys in force in an app; one that knows of none has the registry's."""
    keymap = getattr(app, "keys", STANDARD)
    assert isinstance(keymap, Keymap)
    return keymap


def keys_of(action: Action) -> tuple[str, ...]:
    """Return an action's keys, each in the form that ``canonical`` gives it."""
    return tuple(canonical(key) for key in action.key.split(","))


def canonical(key: str) -> str:
    """Return the one form of a key that can be written in two: ``?`` for ``question_mark``."""
    return character_of(key) or key


def is_typed(key: str) -> bool:
    """Tell whether a key puts something into a line of text, or moves about in it."""
    return len(key) == 1 or key in {"space", "backspace", "delete", "left", "right", "home", "end"}


def _name(key: str) -> str:
    """A key as it can stand between commas."""
    return "comma" if key == "," else key
