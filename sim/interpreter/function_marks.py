"""Marks on functions, by which another thread's stack shows what that thread does.

A mark is a decorator that returns the function unchanged, so that a call costs no more.
"""

from collections.abc import Callable
from traceback import walk_tb
from types import CodeType, FrameType
from typing import Any, TypeVar

FunctionT = TypeVar("FunctionT", bound=Callable[..., Any])


class FunctionMark:
    """A set of functions of one kind; ``frame in mark`` is true if a frame runs one of them."""

    def __init__(self) -> None:
        self._codes: set[CodeType] = set()

    def __call__(self, function: FunctionT) -> FunctionT:
        """Mark a function."""
        self._codes.add(function.__code__)
        return function

    def __contains__(self, frame: FrameType) -> bool:
        return frame.f_code in self._codes

    def raised(self, error: BaseException) -> bool:
        """Return whether a marked function itself raised an exception, not a function that it called."""
        frames = [frame for frame, _ in walk_tb(error.__traceback__)]
        return frames != [] and frames[-1] in self


calls_the_program = FunctionMark()
"""Functions that call a callback or a task of the program."""
waits_for_time = FunctionMark()
"""Functions that wait for time to pass."""
notes_begin = FunctionMark()
"""Functions that wait; their local ``since`` is when they began to."""
asks_time = FunctionMark()
"""Functions that tell the time in place of Python's own, and do not wait."""
waits_for_keyboard = FunctionMark()
"""Functions that wait for input from the run's terminal."""
sends_responses = FunctionMark()
"""Functions that send what a service's callback returned, and raise a TypeError if it is not a response."""
