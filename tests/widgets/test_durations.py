"""Lengths of time in words."""

import pytest

from cbtui.text.durations import duration
from tests.support.runs import ns


@pytest.mark.parametrize(
    ("seconds", "words"),
    [
        (0, "0 us"),
        (0.000_02, "20 us"),
        (0.0008, "0.8 ms"),
        (0.35, "350 ms"),
        (0.9996, "1.0 s"),
        (8.94, "8.9 s"),
        (123, "123 s"),
        (750, "12 min"),
    ],
)
def test_a_duration_is_said_as_a_person_would(seconds: float, words: str) -> None:
    assert duration(ns(seconds)) == words
