"""Lengths and moments of time in words."""

import pytest

from sim.quantities.durations import duration, timestamp


@pytest.mark.parametrize(
    ("length", "words"),
    [
        (0, "0 s"),
        (300, "0 s"),
        (12_400, "12 µs"),
        (70_000, "70 µs"),
        (99_600, "0.1 ms"),
        (800_000, "0.8 ms"),
        (9_940_000, "9.9 ms"),
        (9_960_000, "10 ms"),
        (498_000_000, "498 ms"),
        (999_400_000, "999 ms"),
        (999_600_000, "1.0 s"),
        (9_900_000_000, "9.9 s"),
        (99_960_000_000, "100 s"),
        (123_000_000_000, "123 s"),
        (599_600_000_000, "10 min"),
        (750_000_000_000, "12 min"),
    ],
)
def test_durations_have_the_unit_that_suits_them(length: int, words: str) -> None:
    assert duration(length) == words


def test_a_moment_is_told_to_the_millisecond() -> None:
    assert timestamp(12_345_600_000) == "12.346 s"
