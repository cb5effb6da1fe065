"""Replaces the registry's keys in texts by the keys in force."""

import re

from cbtui.keys.action import KeyAction, Scope
from cbtui.keys.actions import ACTIONS
from cbtui.keys.keymap import STANDARD, Keymap
from cbtui.keys.signs import signs_of
from cbtui.looks.theme import Charset

_FENCE = re.compile(r"^[ ]{0,3}(`{3,}|~{3,})")
_NAMED = re.compile(r"(?<![`\\])`([^`\s]+)`(?!`)")


def key_in_force(key: str, keymap: Keymap) -> str:
    """Return the key in force for a key of the lesson's actions; other text is returned unchanged.

    For a key of several actions that are now on different keys the result is ``x or y``.
    """
    return " or ".join(_in_force(key, keymap)) or key


def with_keys_in_force(markdown: str, keymap: Keymap) -> str:
    """Return a Markdown text with the lesson's keys, each alone in backticks, replaced by those in force.

    Code blocks and other text in backticks stay.
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
    of_lessons = (action for action in ACTIONS if action.scope is Scope.LESSON and not action.refused)
    meant = [action for action in of_lessons if _sign(action, STANDARD) == key]
    return list(dict.fromkeys(_sign(action, keymap) for action in meant))


def _sign(action: KeyAction, keymap: Keymap) -> str:
    return signs_of(keymap.of([action]), Charset.ASCII)
