"""Classrooms with namespaces and without."""

from functools import cache
from pathlib import Path

import pytest

from cbtui.grading.confinement import Confinement
from tests.grading.classroom import Classroom


@cache
def _missing() -> str:
    return Confinement.best([]).missing


@pytest.fixture(params=["confined", "open"])
def classroom(request: pytest.FixtureRequest, tmp_path: Path) -> Classroom:
    """A classroom in which submissions are confined by bwrap, and one where there is none."""
    confined = request.param == "confined"
    if confined and _missing():
        pytest.skip(_missing())
    return Classroom(tmp_path, confined=confined)


@pytest.fixture
def open_classroom(tmp_path: Path) -> Classroom:
    """A classroom without bwrap."""
    return Classroom(tmp_path, confined=False)


@pytest.fixture
def confined_classroom(tmp_path: Path) -> Classroom:
    """A classroom with bwrap."""
    if _missing():
        pytest.skip(_missing())
    return Classroom(tmp_path, confined=True)
