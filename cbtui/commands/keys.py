"""``cbtui keys``: every key with its id, as a configuration to copy from."""

import argparse
import json
from collections.abc import Iterator
from typing import TYPE_CHECKING

from cbtui.commands.options import appearance
from cbtui.text.output import complain, say

if TYPE_CHECKING:
    from cbtui.keys.action import KeyAction

_HEAD = """\
# The keys of cbtui, and how it looks. Keep what you change in
# {path}
# or in a file that you name with --config; what is left out stays as it is.
"""
_KEYS = """\
# A key is a character, such as "p" or "?", or a name, such as "space", "f5", "ctrl+g" or "pageup";
# several keys stand in a list: ["escape", "q"].
[keys]
"""


def print_keys(options: argparse.Namespace) -> int:
    """Print the keys in force; returns the exit code."""
    from cbtui.keys.config import standard_path

    now = appearance.appearance(options)
    for complaint in now.complaints:
        complain(complaint)
    say("\n".join(_lines(str(standard_path()), now)))
    return 0


def _lines(path: str, now: appearance.Appearance) -> Iterator[str]:
    from cbtui.keys.actions import ACTIONS

    yield _HEAD.format(path=path)
    yield f"[display]\ntheme = {json.dumps(now.theme)}\ncharset = {json.dumps(now.configured_charset)}"
    yield f'screen_reader = "{"on" if now.screen_reader else "off"}"\n'
    yield _KEYS
    actions = now.keys.of(action for action in ACTIONS if not action.refused)
    entries = {action: f"{_entry(action)} " for action in actions}
    width = max(map(len, entries.values()))
    for scope in dict.fromkeys(action.scope for action in actions):
        yield f"# {scope.value}"
        for action, entry in entries.items():
            if action.scope is scope:
                yield f"{entry:{width}}# {action.label}: {action.help}"
        yield ""


def _entry(action: "KeyAction") -> str:
    from cbtui.keys.action import key_id
    from cbtui.keys.keymap import keys_of

    keys = [json.dumps(key, ensure_ascii=False) for key in keys_of(action)]
    return f"{key_id(action)} = {keys[0] if len(keys) == 1 else '[' + ', '.join(keys) + ']'}"
