"""Makes texts of a learner's program safe to put into files of various kinds."""

import re

from sim.trace.model import Nanoseconds
from sim.units import SECOND

_CONTROLS = "\x00-\x08\x0b-\x1f\x7f-\x9f"
_DECEIVERS = "\u200b\u200e\u200f\u202a-\u202e\u2060\u2066-\u2069\ufeff"
"""What turns other text round, or stands in it unseen."""
_NO_TEXT = "\ud800-\udfff\ufffe\uffff"
_UNPRINTABLE = re.compile(f"[{_CONTROLS}{_DECEIVERS}{_NO_TEXT}]")
_FORMULA_STARTS = ("=", "+", "-", "@", "\t", "\r", "\n")
_MARKDOWN = re.compile(r"([\\`*\[\]#|~<>&$]|(?<![^\W_])_|_(?![^\W_]))")


def printable(text: str) -> str:
    """The text with what XML or UTF-8 cannot hold, a terminal obeys or a reader is deceived by as ``�``."""
    return _UNPRINTABLE.sub("\N{REPLACEMENT CHARACTER}", text)


def xml(text: str) -> str:
    """The text as content or attribute of XML."""
    escaped = printable(text).replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
    return escaped.replace('"', "&quot;").replace("'", "&#39;")


def cell(text: str) -> str:
    """The text as a spreadsheet's cell: one that a spreadsheet would reckon with begins with ``'``.

    Source: OWASP, "CSV Injection".
    """
    clean = printable(text)
    return f"'{clean}" if text.lstrip(" ").startswith(_FORMULA_STARTS) else clean


def markdown(text: str) -> str:
    """The text on one line of Markdown, in a table too, without any mark-up of its own."""
    return _MARKDOWN.sub(r"\\\1", " ".join(printable(text).split()))


def seconds(time: Nanoseconds) -> str:
    """A time in seconds, exactly: ``12.480000000``."""
    whole, rest = divmod(abs(time), SECOND)
    return f"{'-' if time < 0 else ''}{whole}.{rest:09d}"
