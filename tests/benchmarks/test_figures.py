"""The table of figures: every one can be measured, has a record, and is told against its goal."""

import os
import sys
from dataclasses import replace
from math import isfinite
from pathlib import Path

import pytest

from tests.benchmarks import records
from tests.benchmarks.__main__ import row
from tests.benchmarks.beside import ratios
from tests.benchmarks.figures import FIGURES, DearFigure, Figure
from tests.real.programs import needs_ros
from tests.support.daily import first_daily

DEAR = "CBTUI_DEAR_FIGURES" in os.environ
"""Whether those are measured too that take a console each."""


@pytest.mark.parametrize(
    "figure",
    first_daily(*(figure for figure in FIGURES if DEAR or not isinstance(figure, DearFigure))),
    ids=lambda figure: figure.name,
)
def test_every_figure_can_be_measured(figure: Figure) -> None:
    assert isfinite(figure.measure(20))  # a difference of two timings can come out below 0


def test_every_figure_has_a_name_of_its_own_and_every_record_is_one_s() -> None:
    names = [figure.name for figure in FIGURES]
    known = records.read()
    assert len(set(names)) == len(names)
    assert list(known.last) == names
    assert set(known.before) <= set(known.last)


def test_records_are_read_as_they_were_written(tmp_path: Path) -> None:
    file = tmp_path / "recorded.toml"
    written = records.Records({"a, b": 1670.0}, {"a, b": 0.155, "1 ms": 12.5}, {"1 ms": 0.5}, "2 cores")
    records.write(written, file)
    assert records.read(file) == written


def test_a_row_tells_the_change_since_the_last_record_and_a_missed_goal() -> None:
    figure = replace(FIGURES[0], name="timer", unit="u", goal=120.0, rclpy="900")
    known = records.Records({"timer": 133.0}, {"timer": 100.0})
    assert row(figure, known, 110.0).split() == ["timer", "u", "120", "900", "133", "100", "110", "+10%"]
    assert row(figure, known, 150.0).split()[-2:] == ["+50%", "over"]


def test_a_row_of_a_figure_without_record_has_gaps() -> None:
    figure = replace(FIGURES[0], name="timer", rclpy="")
    assert row(figure, records.Records({}, {}), 0.25).split() == ["timer", "u", "120", "0.25"]


@needs_ros
@pytest.mark.slow
def test_real_executors_are_measured_beside_the_models() -> None:
    assert len([ratio for _, ratio in ratios(sys.executable, rounds=1) if ratio > 0]) == 6
