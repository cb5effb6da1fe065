"""Texts that name keys, shown with the keys that the person has: in files they name those of the registry."""

import re

from cbtui.keys.action import Action, Scope
from cbtui.keys.actions import ACTIONS
from cbtui.keys.keymap import STANDARD, Keymap
from cbtui.keys.signs import signs_of
from cbtui.looks.theme import Charset

_FENCE = re.compile(r"^[ ]{0,3}(`{3,}|~{3,})")
_NAMED = re.compile(r"(?<![`\\])`([^`\s]+)`(?!`)")


def key_in_force(key: str, keymap: Keymap) -> str:
    """Return what a lesson's key is now, in words where it types nothing; what is no such key stays.

    A key of several actions that have different ones now is ``x or y``.
    """
    return " or ".join(_in_force(key, keymap)) or key


def with_keys_in_force(markdown: str, keymap: Keymap) -> str:
    """Return a text in which the lesson's keys, each alone in backticks, are those in force.

    What stands in blocks of code, and whatever else is in backticks, stays.
    """
    shown, fence = [], ""
    for line in markdown.splitlines(keepends=True):
        opening = _FENCE.match(line)
        if fence:
            fence = "" if opening and opening[1].startswith(fence) else fence
        elif opening:
            fence = opening[1]
        else:
            line = _NAMED.sub(lambda found: _quoted(found[1], keymap), line)  # noqa: PLW2901
        shown.append(line)
    return "".join(shown)


def _quoted(key: str, keymap: Keymap) -> str:
    return " or ".join(f"`{sign}`" for sign in _in_force(key, keymap) or [key])


def _in_force(key: str, keymap: Keymap) -> list[str]:
    meant = [action for action in ACTIONS if action.scope is Scope.LESSON and _sign(action, STANDARD) == key]
    return list(dict.fromkeys(_sign(action, keymap) for action in meant))


def _sign(action: Action, keymap: Keymap) -> str:
    return signs_of(keymap.of([action]), Charset.ASCII)
