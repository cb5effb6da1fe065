"""Keys as they are displayed."""

from collections.abc import Iterable

from textual.keys import format_key, key_to_character

from cbtui.keys.action import KeyAction
from cbtui.looks.theme import Charset

_SIGNS = {
    "enter": "⏎",
    "space": "␣",
    "up": "↑",
    "down": "↓",
    "left": "←",
    "right": "→",
    "escape": "esc",
    "delete": "del",
}
_PLAIN_SIGNS = _SIGNS | {
    "enter": "enter",
    "space": "space",
    "up": "up",
    "down": "down",
    "left": "left",
    "right": "right",
}


def signs_of(actions: Iterable[KeyAction], charset: Charset) -> str:
    """Return the keys of some actions for display, numbers last."""
    keys = list(dict.fromkeys(action.key.partition(",")[0] for action in actions))
    digits = [key for key in keys if key.isdigit()]
    if len(digits) > 1:
        is_row = len(digits) > 2 and "".join(digits) in "0123456789"
        numbers = [f"{digits[0]}-{digits[-1]}"] if is_row else digits
        keys = [*(key for key in keys if key not in digits), *numbers]
    return " ".join(_sign(key, charset) for key in keys)


def character_of(key: str) -> str | None:
    """Return the character of a key, ``?`` for ``question_mark``; None for space and for keys without one."""
    if len(key) == 1:
        return key
    character = key_to_character(key)
    if character is None and len(format_key(key)) == 1 and format_key(key).isascii():
        character = format_key(key)  # minus, slash and other keys that Textual renames
    return character if character is not None and character.isprintable() and character != " " else None


def _sign(key: str, charset: Charset) -> str:
    signs = _PLAIN_SIGNS if charset is Charset.ASCII else _SIGNS
    character = character_of(key)
    if key in signs:
        return signs[key]
    if character is not None and (character.isascii() or charset is not Charset.ASCII):
        return character
    return f"^{_sign(key.removeprefix('ctrl+'), charset)}" if key.startswith("ctrl+") else key
