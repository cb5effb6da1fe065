"""Removes the probe's frames from the tracebacks that a program prints or logs."""

from __future__ import annotations

from pathlib import Path
from typing import Any

_HERE = str(Path(__file__).parent)


def leave_out_probe(error: BaseException) -> None:
    """Remove the probe's frames from the traceback of an exception that is raised again.

    On Python 3.10 the frame that raises it stays.
    """
    kept, trace = [], error.__traceback__
    while trace is not None:
        if not trace.tb_frame.f_code.co_filename.startswith(_HERE):
            kept.append(trace)
        trace = trace.tb_next
    inner = None
    for each in reversed(kept):
        each.tb_next, inner = inner, each
    error.__traceback__ = inner


class _Unseen:
    """A context that removes the probe's frames from exceptions; hot paths call the function instead."""

    def __enter__(self) -> None:
        return None

    def __exit__(self, _kind: Any, error: BaseException | None, _trace: Any) -> None:
        if error is not None:
            leave_out_probe(error)


UNSEEN = _Unseen()
