"""What commands write: text that any terminal can show, and complaints of one line."""

import sys
from typing import TextIO


def say(text: str) -> None:
    """Write to standard output, in plain characters where it takes no others."""
    _write(sys.stdout, text)


def complain(sentence: str) -> None:
    """Write one line to standard error."""
    _write(sys.stderr, f"cbtui: {sentence}\n")


def _write(stream: TextIO, text: str) -> None:
    encoding = (stream.encoding or "ascii").lower().replace("-", "").replace("_", "")
    if not encoding.startswith("utf") and not text.isascii():
        from cbtui.ascii_filter import in_ascii  # with Textual, so only where it is needed

        text = in_ascii(text)
    stream.write(text)
    stream.flush()
