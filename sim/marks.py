"""Marks on functions: a thread that is looked at from outside tells by its frames what it does.

A mark is a decorator. It changes nothing about the function, so that it costs nothing when that is called.
"""

from collections.abc import Callable
from traceback import walk_tb
from types import CodeType, FrameType
from typing import Any, TypeVar

FunctionT = TypeVar("FunctionT", bound=Callable[..., Any])


class FunctionMark:
    """Functions that do one kind of thing; ``frame in mark`` tells whether a frame runs one of them."""

    def __init__(self) -> None:
        self._codes: set[CodeType] = set()

    def __call__(self, function: FunctionT) -> FunctionT:
        """Mark a function."""
        self._codes.add(function.__code__)
        return function

    def __contains__(self, frame: FrameType) -> bool:
        return frame.f_code in self._codes

    def raised(self, error: BaseException) -> bool:
        """Whether one of them raised an exception, and nothing that it called."""
        frames = [frame for frame, _ in walk_tb(error.__traceback__)]
        return frames != [] and frames[-1] in self


calls_the_program = FunctionMark()
"""Calls a callback or a task that the program wrote."""
waits_for_time = FunctionMark()
"""Waits for time to pass."""
waits_for_keyboard = FunctionMark()
"""Waits for what is typed at the run's terminal."""
sends_responses = FunctionMark()
"""Sends what a service's callback returned, and raises a TypeError if that is no response."""
