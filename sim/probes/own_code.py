"""Finds the learner's own code on a thread's stack."""

from __future__ import annotations

import dis
import sys
import sysconfig
from collections.abc import Iterator
from itertools import takewhile
from pathlib import Path
from types import FrameType


def outwards(frame: FrameType | None) -> Iterator[FrameType]:
    """Yield a frame, its caller, and so on."""
    while frame is not None:
        yield frame
        frame = frame.f_back


def module_root(frame: FrameType) -> str:
    """The top-level package of a frame's module."""
    return str(frame.f_globals.get("__name__", "")).partition(".")[0]


def is_own(frame: FrameType) -> bool:
    """Whether a frame runs neither cbtui's code, its model's, nor the standard library's."""
    root = module_root(frame)
    return root not in ("sim", "cbtui") and (root == "__main__" or root not in sys.stdlib_module_names)


def is_library(frame: FrameType) -> bool:
    """Whether a frame runs the code of an installed package."""
    return "site-packages" in Path(frame.f_code.co_filename).parts


def is_written(file: str) -> bool:
    """Whether a file is neither of Python's library, of an installed package, nor of the model."""
    inside = (sysconfig.get_paths()["stdlib"], str(Path(__file__).parents[1]))
    return not file.startswith(("<", *inside)) and "site-packages" not in Path(file).parts


def own_frame(frame: FrameType | None) -> FrameType | None:
    """The innermost frame of a file of the learner's own, from a frame outwards."""
    own = filter(is_own, outwards(frame))
    return next((each for each in own if not each.f_code.co_filename.startswith("<")), None)


def called_by_own(top: FrameType | None) -> list[FrameType]:
    """The frames that the innermost one of the learner's own has called."""
    return list(takewhile(lambda frame: not is_own(frame), outwards(top)))


def place_of(frame: FrameType | None) -> str:
    """The line of the innermost frame of the learner's own, as ``node.py:12, in tick``; "" for none."""
    own = own_frame(frame)
    return "" if own is None else place_text(own.f_code.co_filename, own.f_code.co_name, own.f_lineno)


def place_text(file: str, function: str, line: int) -> str:
    """The line of a function, as ``node.py:12, in tick``."""
    return f"{Path(file).name}:{line}, in {function}"


def call_into_ros() -> tuple[str, str, int]:
    """The function of rclpy's that the learner's code called on this thread, the file and line of the call.

    File and line are "" and 0 if no frame is the learner's own, as on a thread that only spins.
    """
    function = ""
    for frame in outwards(sys._getframe(1)):
        if is_own(frame):
            return function, frame.f_code.co_filename, frame.f_lineno
        if str(frame.f_globals.get("__name__")).startswith("sim.ros"):
            function = frame.f_code.co_name
    return function, "", 0


def has_timeout() -> bool:
    """Whether the function of rclpy's that the learner's code called on this thread got a ``timeout_sec``."""
    called: FrameType | None = None
    for frame in outwards(sys._getframe(1)):
        if is_own(frame):
            break
        called = frame
    timeout = None if called is None else called.f_locals.get("timeout_sec")
    return timeout is not None and timeout >= 0


def is_result_dropped() -> bool:
    """Whether the learner's code makes nothing of what the function that it called on this thread returns."""
    frame = own_frame(sys._getframe(1))
    if frame is None:
        return False
    code = dis.get_instructions(frame.f_code)
    return next((each.opname for each in code if each.offset > frame.f_lasti), "") == "POP_TOP"


def place_of_caller() -> str:
    """``place_of`` on the calling thread."""
    return place_of(sys._getframe(1))


def line_of_caller() -> tuple[str, int]:
    """The file and line of the learner's code on the calling thread; "" and 0 if none of its frames is."""
    frame = own_frame(sys._getframe(1))
    return ("", 0) if frame is None else (frame.f_code.co_filename, frame.f_lineno)
