"""What lies in the current folder is not taken for Python's own: a learner's threading.py, or a trap."""

from pathlib import Path
from queue import Queue

import pytest

from sim.camera import Camera, Picture
from sim.trace.events import Printed
from tests.camera.shots import shot
from tests.camera.test_camera import echo
from tests.support.engine_runs import run_program


@pytest.fixture(autouse=True)
def traps(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The current folder, with modules in it that are imported as a process starts."""
    for name in ("threading", "signal", "socket", "selectors"):
        (tmp_path / f"{name}.py").write_text("raise SystemExit('not what was wanted')\n")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.usefixtures("fresh_engines")
def test_a_program_from_elsewhere_runs_and_what_it_starts_looks_where_python_does(traps: Path) -> None:
    elsewhere = traps / "elsewhere"
    elsewhere.mkdir()
    run = run_program(elsewhere, "import os\nprint(os.environ.get('PYTHONSAFEPATH'))\n")
    assert run.loss is None
    assert [event.text for event in run.events if isinstance(event, Printed)] == ["None"]


def test_a_picture_is_taken() -> None:
    pictures: Queue[Picture] = Queue()
    camera = Camera(pictures.put, lambda _: None, echo)
    try:
        camera.want(shot(width=3))
        assert pictures.get(timeout=60).width == 3
    finally:
        camera.stop()
