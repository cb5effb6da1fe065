"""The pace of a run: told where it falls short of the asked speed."""

import pytest

from cbtui.runs.live.pace import PaceMeter
from tests.support.builder import ns


class Run:
    """A meter of a run, whose events come ten times a real second."""

    def __init__(self) -> None:
        self.real = 0.0
        self.end = 0.0
        self.meter = PaceMeter(lambda: self.real)

    def goes(self, seconds: float, pace: float, asked: float | None = 1.0) -> None:
        for _ in range(round(10 * seconds)):
            self.real += 0.1
            self.end += 0.1 * pace
            self.meter.note(ns(self.end), asked)


def test_a_run_that_falls_short_of_the_asked_speed_is_told_with_its_pace() -> None:
    run = Run()
    run.goes(4, pace=0.3)
    assert run.meter.slow == pytest.approx(0.3)
    run.goes(4, pace=1.0)
    assert run.meter.slow is None


def test_nothing_is_told_of_a_run_at_the_asked_speed_nor_before_it_was_measured() -> None:
    run = Run()
    assert run.meter.slow is None
    run.goes(2, pace=0.3)
    assert run.meter.slow is None
    for asked in (1.0, 0.5, 2.0):
        run.goes(4, pace=0.9 * asked, asked=asked)
        assert run.meter.slow is None


def test_time_that_stands_counts_neither_while_it_does_nor_afterwards() -> None:
    run = Run()
    run.goes(4, pace=1.0)
    run.goes(4, pace=0.0, asked=None)
    assert run.meter.slow is None
    run.goes(2, pace=1.0)
    run.real += 20
    assert run.meter.slow is None
    run.goes(4, pace=1.0)
    assert run.meter.slow is None
