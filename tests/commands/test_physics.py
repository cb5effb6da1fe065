"""``--physics``: what moves the robot is what the command line says."""

from pathlib import Path

import pytest

from tests.support.commands import cbtui

RUN = ("run", "single-thread", "--for", "1", "--physics")


@pytest.fixture
def broken_pybullet(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "pybullet.py").write_text("raise ImportError('of another machine')\n")
    monkeypatch.syspath_prepend(tmp_path)


def test_numpy_moves_the_robot_where_it_is_asked_for_and_the_recording_tells(
    broken_pybullet: None, tmp_path: Path
) -> None:
    recording = str(tmp_path / "run.mcap")
    done = cbtui(*RUN, "numpy", "--record", recording)
    assert done.returncode == 0, done.stderr
    assert "changed    numpy physics\n" in cbtui("info", recording).stdout


def test_pybullet_is_what_a_run_fails_for_that_asks_for_it(broken_pybullet: None) -> None:
    done = cbtui(*RUN, "pybullet")
    assert done.returncode == 1
    assert "PyBullet cannot be imported by this Python (of another machine)" in done.stderr
    assert "--physics numpy moves the robot without it" in done.stderr
