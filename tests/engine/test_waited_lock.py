"""What is known of a lock that is waited for is read from frames, whatever these have come to."""

import sys
from collections.abc import Callable
from types import FunctionType

from sim.engine.waited_lock import decorated


def locked(function: Callable[[], object]) -> Callable[[], object]:
    def inner() -> object:
        result = function()  # not set while the function runs
        return result  # noqa: RET504

    return inner


def test_a_function_without_parameters_whose_first_variable_is_not_set_yet_is_looked_at() -> None:
    seen: list[FunctionType | None] = []
    locked(lambda: seen.append(decorated(sys._getframe(1))))()
    assert seen == [None]
