"""The ``[keys]`` table of a configuration: its validation, and the keymap of the valid entries."""

from collections.abc import Callable, Iterator, Mapping
from difflib import get_close_matches
from itertools import combinations

from textual.keys import Keys

from cbtui.keys.action import KeyAction, Scope, key_id
from cbtui.keys.actions import ACTIONS, actions_of
from cbtui.keys.keymap import Keymap, canonical, is_typed, keys_of

Complain = Callable[[str, str], None]
"""Receives a key id and what is wrong with its entry."""

_NEVER_COME = {"ctrl+i": "tab", "ctrl+m": "enter", "ctrl+h": "backspace", "ctrl+j": "enter", "ctrl+s": "stop"}
"""Keys that terminals send as other keys, or never send."""
_UNREAL = {"return", "ctrl-at", "ctrl+@"}
_NAMES = {key.value for key in Keys if not key.value.startswith("<")} - _UNREAL
_OF_WIDGETS = {
    *("left", "right", "up", "down", "home", "end", "pageup", "pagedown"),
    *("tab", "shift+tab", "enter", "ctrl+c"),
}
"""Keys that panes use for scrolling and focus."""
_QUIT = "ctrl+q"

_BY_ID = {key_id(action): action for action in ACTIONS}


def read_keys(table: Mapping[str, object], complain: Complain) -> Keymap:
    """Return the keymap of the valid entries (by key id); ``complain`` is called for the others."""
    chosen = {}
    for name, value in table.items():
        try:
            chosen[name] = _keys(_action(name), value)
        except ValueError as error:
            complain(name, str(error))
    while (clash := next(_clashes(Keymap(chosen)), None)) is not None:
        first, second, key = clash
        wrong = next(name for name in reversed(chosen) if name in {first, second})
        other = second if wrong == first else first
        complain(wrong, f"{wrong} and {other} would both be {key}; give one of them another key")
        del chosen[wrong]
    return Keymap(chosen)


def _action(name: str) -> KeyAction:
    if name in _BY_ID:
        return _BY_ID[name]
    near = get_close_matches(name, _BY_ID, n=1)
    raise ValueError(
        f"there is no action {name}; " + (f"did you mean {near[0]}?" if near else "cbtui keys lists them")
    )


def _keys(action: KeyAction, value: object) -> tuple[str, ...]:
    values = value if isinstance(value, list) else [value]
    written = [each for each in values if isinstance(each, str)]
    if not values or written != values:
        raise ValueError(f"{key_id(action)} has to be a key, or a list of keys, each in quotation marks")
    return tuple(_key(action, each) for each in written)


def _key(action: KeyAction, written: str) -> str:
    key = canonical(written if len(written) == 1 else written.lower())
    if key in _NEVER_COME:
        raise ValueError(
            f"terminals keep {key} for {_NEVER_COME[key]}; choose another key for {key_id(action)}"
        )
    if key == _QUIT:
        raise ValueError(f"{_QUIT} always leaves the console; choose another key for {key_id(action)}")
    if key not in _NAMES and not (len(key) == 1 and key.isprintable() and key != " "):
        near = get_close_matches(key, _NAMES, n=1)
        hint = (
            f"did you mean '{near[0]}'?" if near else "write a character, or a name such as 'space' or 'f5'"
        )
        raise ValueError(f"'{written}' is not the name of a key; {hint}")
    if is_typed(key) and not any(is_typed(each) for other in _neighbours(action) for each in keys_of(other)):
        raise ValueError(f"'{written}' is typed where {key_id(action)} works; choose a key such as 'f5'")
    if key in _OF_WIDGETS and not _OF_WIDGETS.intersection(keys_of(action)):
        raise ValueError(f"'{written}' belongs to the panes; choose another key for {key_id(action)}")
    return key


def _neighbours(action: KeyAction) -> list[KeyAction]:
    return [other for other in ACTIONS if other.scope is action.scope]


def _clashes(keymap: Keymap) -> Iterator[tuple[str, str, str]]:
    """Yield pairs of actions that share a key where they do not share one in the registry."""
    for scope in Scope:
        own = [action for action in actions_of(scope) if not action.refused]
        keys = [
            (key_id(action), set(keys_of(action)), set(keys_of(now)))
            for action, now in zip(own, keymap.of(own), strict=True)
        ]
        for (one, usual, now), (other, others_usual, others_now) in combinations(keys, 2):
            if now & others_now and not usual & others_usual:
                yield one, other, min(now & others_now)
