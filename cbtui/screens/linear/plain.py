"""Text for screen readers: without markup, frames and signs."""

import re

from cbtui.keys.action import KeyAction
from cbtui.looks.theme import Charset
from cbtui.text.cells import visible

_WORDS = {
    " → ": ", ",
    "→ ": "",
    "✓ ": "right: ",
    "✗ ": "wrong: ",
    "· ": "",
    " · ": ", ",
    "⏎": "enter",
    "␣": "space",
    "▌": "",
    "×": "times ",
}
_MARKUP = re.compile(r"(?<!\\)[*`]+|^(?:#+|>) *", re.MULTILINE)
_ESCAPE = re.compile(r"\\([!-/:-@\[-`{-~])")
_CONTINUATION = re.compile(r"(?<!\n)\n[ ]*(?=[^\s-])(?!\d+\. )")
_FENCE = re.compile(r"^```.*\n?", re.MULTILINE)


def plain(text: str) -> str:
    """Return a line of words, safe for a terminal."""
    for sign, word in _WORDS.items():
        text = text.replace(sign, word)
    return visible(text, Charset.BRAILLE)


def plain_lines(markdown: str) -> list[str]:
    """Return the paragraphs and lines of a Markdown text, each paragraph as one line."""
    text = _MARKUP.sub("", _FENCE.sub("", markdown))
    joined = _ESCAPE.sub(r"\1", _CONTINUATION.sub(" ", text))
    return [plain(line.strip()) for line in joined.split("\n") if line.strip()]


def spoken_key(action: KeyAction) -> str:
    """Return the first key of an action in words: ``comma``, ``capital S``."""
    key = action.key.partition(",")[0]
    return f"capital {key}" if key.isupper() else key.replace("_", " ")
