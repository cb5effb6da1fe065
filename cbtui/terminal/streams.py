"""Repairs standard streams that the parent process closed or that cannot encode every character."""

import os
import sys
from contextlib import suppress
from io import TextIOWrapper
from typing import TextIO

_NAMES = ("stdin", "stdout", "stderr")
_LAST = 2


def repair_streams() -> None:
    """Open to nowhere what is closed of standard input, output and error, and let every text be written.

    The next file to be opened would else get the number of a stream that is closed, and whatever engines and
    C code write to the stream. A sign that the encoding of the output lacks is written as a question mark.
    """
    _fill_descriptors()
    for descriptor, name in enumerate(_NAMES):
        if getattr(sys, name) is None:
            stream = os.fdopen(descriptor, "w" if descriptor else "r", encoding="utf-8", closefd=False)
            setattr(sys, name, stream)
            setattr(sys, f"__{name}__", stream)
    if isinstance(sys.stdout, TextIOWrapper) and sys.stdout.errors == "strict":
        sys.stdout.reconfigure(errors="replace")


def _fill_descriptors() -> None:
    while (descriptor := os.open(os.devnull, os.O_RDWR)) <= _LAST:
        os.set_inheritable(descriptor, True)
    os.close(descriptor)


def flush_streams() -> OSError | None:
    """Write out what waits in standard output and error, and drop what takes no more.

    Returns why standard output does not, if so.
    """
    _trouble_of(sys.stderr)
    return _trouble_of(sys.stdout)


def _trouble_of(stream: TextIO) -> OSError | None:
    try:
        stream.flush()
    except OSError as error:
        # Python would try once more as it ends, complain in its own words, and end with 120.
        with suppress(OSError):
            os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
        return error
    return None
