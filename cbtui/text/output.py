"""Output of commands: text that is safe for any terminal, and error messages of one line."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TextIO

from cbtui.text.colours import with_coloured_signs


def say(text: str) -> None:
    """Write to standard output, in ASCII if its encoding is not Unicode; signs are coloured on a terminal."""
    _write(sys.stdout, with_coloured_signs(shown(text), sys.stdout))


def say_data(data: str) -> None:
    """Write data for another program to standard output, unchanged except for control characters."""
    from sim.export.texts import printable

    _write(sys.stdout, printable(data))


def complain(sentence: str) -> None:
    """Write one line to standard error."""
    _write(sys.stderr, shown(f"cbtui: {sentence}\n"))


def shown(text: str) -> str:
    """Return text with control and invisible characters made visible; newlines stay."""
    lines = text.split("\n")
    if all(map(str.isprintable, lines)):
        return text
    from cbtui.looks.theme import Charset
    from cbtui.text.cells import visible

    return "\n".join(visible(line, Charset.BRAILLE) for line in lines)


class CannotSayError(OSError):
    """A standard stream cannot be written."""


@contextmanager
def writing_to_stream() -> Iterator[None]:
    """Mark errors inside the block as those of a standard stream, to tell them from errors of files.

    Raises:
        BrokenPipeError: the reader of the stream has closed it.
        CannotSayError: writing failed for another reason.
    """
    try:
        yield
    except BrokenPipeError:
        raise
    except OSError as error:
        raise CannotSayError(error.errno, error.strerror) from error


def _write(stream: TextIO, text: str) -> None:
    encoding = (stream.encoding or "ascii").lower().replace("-", "").replace("_", "")
    if not encoding.startswith("utf") and not text.isascii():
        from cbtui.text.ascii_filter import in_ascii  # imported late: it needs Textual

        text = in_ascii(text)
    with writing_to_stream():
        stream.write(text)
        stream.flush()


def is_text(word: str) -> bool:
    """Tell whether a command-line word or file name is text, not bytes that could not be decoded."""
    return not any("\ud800" <= character <= "\udfff" for character in word)
