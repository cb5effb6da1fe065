"""Makes text from a learner's program safe for files of various kinds."""

import re
from typing import TYPE_CHECKING

from sim.quantities.nanoseconds import SECOND

if TYPE_CHECKING:
    from sim.trace.model import Nanoseconds

_CONTROLS = "\x00-\x08\x0b-\x1f\x7f-\x9f"
_DECEPTIVE = "\u200b\u200e\u200f\u202a-\u202e\u2060\u2066-\u2069\ufeff"
"""Characters that reverse other text, or are invisible in it."""
_NO_TEXT = "\ud800-\udfff\ufffe\uffff"
_UNPRINTABLE = re.compile(f"[{_CONTROLS}{_DECEPTIVE}{_NO_TEXT}]")
_FORMULA_STARTS = ("=", "+", "-", "@", "\t", "\r", "\n")
_MARKDOWN = re.compile(r"([\\`*\[\]#|~<>&$]|(?<![^\W_])_|_(?![^\W_]))")


def printable(text: str) -> str:
    """Replace what XML or UTF-8 cannot hold, a terminal executes or a reader is deceived by with ``�``."""
    return _UNPRINTABLE.sub("\N{REPLACEMENT CHARACTER}", text)


def xml(text: str) -> str:
    """The text as content or attribute of XML."""
    escaped = printable(text).replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
    return escaped.replace('"', "&quot;").replace("'", "&#39;")


def cell(text: str) -> str:
    """The text as a spreadsheet's cell: one that a spreadsheet would take for a formula begins with ``'``.

    Source: OWASP, "CSV Injection".
    """
    clean = printable(text)
    return f"'{clean}" if text.lstrip(" ").startswith(_FORMULA_STARTS) else clean


def markdown(text: str) -> str:
    """The text on one line of Markdown, in a table too, without any mark-up of its own."""
    return _MARKDOWN.sub(r"\\\1", " ".join(printable(text).split()))


def seconds(time: "Nanoseconds") -> str:
    """A time in seconds, exactly: ``12.480000000``."""
    whole, rest = divmod(abs(time), SECOND)
    return f"{'-' if time < 0 else ''}{whole}.{rest:09d}"
