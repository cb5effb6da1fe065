"""Which of a test's cases are run each time, and which with the slow tests."""

from typing import Any

import pytest


def first_daily(case: Any, *others: Any) -> list[Any]:
    """Return the values of a parameter of a long test; all but the first are left to the slow run."""
    return [case, *(pytest.param(other, marks=pytest.mark.slow) for other in others)]


def first_slow(case: Any, *others: Any) -> list[Any]:
    """Return the values of a parameter of a slow test; all but the first are bulk, left to whoever asks."""
    return [
        pytest.param(case, marks=pytest.mark.slow),
        *(pytest.param(other, marks=pytest.mark.bulk) for other in others),
    ]


def first_row_daily(row: tuple[Any, ...], *others: tuple[Any, ...]) -> list[Any]:
    """Return the values of several parameters of a long test; all but the first are left to the slow run."""
    return [row, *(pytest.param(*other, marks=pytest.mark.slow) for other in others)]
