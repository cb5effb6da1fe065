"""Tracebacks of the learner's code alone, without frames of the model and the engine."""

import traceback
from types import TracebackType
from typing import Any

from sim.probes.own_code import is_library, is_own, module_root


class LearnersTraceback(traceback.TracebackException):
    """A traceback as Python prints it, of the learner's code and what that called.

    Frames of the model and the engine are left out, and those of Python's modules and installed packages that
    the model called. If no frame is left, only the exception is printed.
    """

    def __init__(
        self,
        exc_type: type[BaseException],
        exc_value: BaseException,
        exc_traceback: TracebackType | None,
        **options: Any,
    ) -> None:
        super().__init__(exc_type, exc_value, _learners(exc_traceback), **options)
        if not self.stack:
            without: Any = None
            self.stack = without


def leave_out_own_frames() -> None:
    """Print all tracebacks of Python's ``traceback`` module, which ``logging`` also uses, in this way.

    The module looks up its class whenever it prints (Python 3.11 to 3.13).
    """
    module: Any = traceback
    module.TracebackException = LearnersTraceback


def _learners(trace: TracebackType | None) -> TracebackType | None:
    kept: list[TracebackType] = []
    models = True
    while trace is not None:
        frame = trace.tb_frame
        if module_root(frame) == "sim":
            models = True
        elif is_own(frame) and not is_library(frame):
            models = False
        if not models and module_root(frame) != "importlib":
            kept.append(trace)
        trace = trace.tb_next
    inner: TracebackType | None = None
    for each in reversed(kept):
        inner = TracebackType(inner, each.tb_frame, each.tb_lasti, each.tb_lineno)
    return inner
