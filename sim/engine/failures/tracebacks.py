"""Tracebacks without the frames of the model, of the engine and of what these call: the learner's alone."""

import traceback
from types import TracebackType
from typing import Any

from sim.probes.own_code import is_library, is_own, module_root


class LearnersTraceback(traceback.TracebackException):
    """A traceback as Python prints it, of what the learner's code called and of what that called.

    Frames of the model and of the engine are left out, and those of Python's own modules and of installed
    packages where these run on behalf of the model. Where no frame is left, the exception is told alone.
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
    """Have all that goes through Python's ``traceback`` module, as ``logging`` does, printed in this way.

    The module looks its class up whenever it prints (Python 3.11 to 3.13).
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
