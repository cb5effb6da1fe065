"""What commands write: text that any terminal can show and none obeys, and complaints of one line."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TextIO


def say(text: str) -> None:
    """Write to standard output, in plain characters where it takes no others."""
    _write(sys.stdout, shown(text))


def say_data(data: str) -> None:
    """Write what another program reads to standard output, as it is but for what a terminal would obey."""
    from sim.export.texts import printable

    _write(sys.stdout, printable(data))


def complain(sentence: str) -> None:
    """Write one line to standard error."""
    _write(sys.stderr, shown(f"cbtui: {sentence}\n"))


def shown(text: str) -> str:
    """Return text with control characters, and others that cannot be seen, as signs; lines stay lines."""
    lines = text.split("\n")
    if all(map(str.isprintable, lines)):
        return text
    from cbtui.looks.theme import Charset
    from cbtui.text.cells import visible

    return "\n".join(visible(line, Charset.BRAILLE) for line in lines)


class CannotSayError(OSError):
    """A standard stream takes no more."""


@contextmanager
def writing_to_stream() -> Iterator[None]:
    """Have an error of what is written inside, to a standard stream, told from those of files.

    Raises:
        BrokenPipeError: who read the stream has gone.
        CannotSayError: it takes no more for another reason.
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
        from cbtui.text.ascii_filter import in_ascii  # with Textual, so only where it is needed

        text = in_ascii(text)
    with writing_to_stream():
        stream.write(text)
        stream.flush()


def is_text(word: str) -> bool:
    """Tell whether a word of a command line or a name is text, not bytes that no encoding explains."""
    return not any("\ud800" <= character <= "\udfff" for character in word)
