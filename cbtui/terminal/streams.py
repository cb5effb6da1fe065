"""Repairs standard streams that are closed or cannot encode every character."""

import os
import sys
from contextlib import suppress
from io import TextIOWrapper
from typing import TextIO

_NAMES = ("stdin", "stdout", "stderr")
_LAST = 2


def repair_streams() -> None:
    """Open closed standard streams on the null device, and write characters that the encoding lacks as ``?``.

    Otherwise the next opened file would get the descriptor of a closed stream, and with it the output of
    engines and C code.
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
    """Flush standard output and error; a stream that fails is redirected to the null device.

    Returns the error of standard output, if any.
    """
    _trouble_of(sys.stderr)
    return _trouble_of(sys.stdout)


def _trouble_of(stream: TextIO) -> OSError | None:
    try:
        stream.flush()
    except OSError as error:
        # At exit Python would flush once more, print the error, and exit with 120.
        with suppress(OSError):
            os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
        return error
    return None
