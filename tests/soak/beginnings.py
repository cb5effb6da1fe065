"""Where a walk begins: each makes a console, in a folder for whatever it may save."""

from collections.abc import Callable
from pathlib import Path
from random import Random
from typing import TypeAlias

from cbtui.app import CbtuiApp
from cbtui.runs.compared_runs import ComparedRun, ComparisonTerms
from lessons.catalogue import lessons
from sim.recording import Recording, RecordingMetadata, RecordingWriter, read
from tests.support.builder import ns
from tests.support.console import RecordedConsole
from tests.support.fake_session import FakeEngines
from tests.support.runs import dummy_server_run, shared_group_run, split_groups_run

Begin: TypeAlias = Callable[[Random, Path], CbtuiApp]

RUNS = [run().events for run in (shared_group_run, split_groups_run, dummy_server_run)]
BEGUN = 4.0
"""Seconds of a run without an engine that are there from the start."""
_PROGRAM = "import rclpy\n\nrclpy.init()\nrclpy.spin(rclpy.create_node('mine'))\n"


def _engines(chance: Random) -> FakeEngines:
    return FakeEngines(chance.choice(RUNS), ns(BEGUN))


def _menu(chance: Random, folder: Path) -> CbtuiApp:
    return CbtuiApp(open_session=_engines(chance))


def _lesson(chance: Random, folder: Path) -> CbtuiApp:
    return RecordedConsole(any_lesson(chance), chance.choice(RUNS), BEGUN)


def _ascii_lesson(chance: Random, folder: Path) -> CbtuiApp:
    return RecordedConsole(any_lesson(chance), chance.choice(RUNS), BEGUN, charset="ascii", theme="light")


def _file(chance: Random, folder: Path) -> CbtuiApp:
    return CbtuiApp(start_file=(program(folder), ["-v"], "real"), open_session=_engines(chance))


def _recording(chance: Random, folder: Path) -> CbtuiApp:
    return CbtuiApp(start_recording=recorded(chance, folder / "run.mcap"), open_session=_engines(chance))


def _comparison(chance: Random, folder: Path) -> CbtuiApp:
    first, second = (
        ComparedRun(name, recorded(chance, folder / f"{name}.mcap").path) for name in ("before", "after")
    )
    return CbtuiApp(start_comparison=(first, second, ComparisonTerms()))


def _menu_with_engines(chance: Random, folder: Path) -> CbtuiApp:
    return CbtuiApp()


def _lesson_with_engine(chance: Random, folder: Path) -> CbtuiApp:
    return CbtuiApp(start_lesson=any_lesson(chance))


def _file_with_engine(chance: Random, folder: Path) -> CbtuiApp:
    return CbtuiApp(start_file=(program(folder), [], "real"))


def any_lesson(chance: Random) -> str:
    """The id of a lesson."""
    return chance.choice([lesson.id for lesson in lessons()])


def program(folder: Path) -> Path:
    """A file with a node of somebody's own."""
    path = folder / "my_node.py"
    path.write_text(_PROGRAM)
    return path


def recorded(chance: Random, path: Path) -> Recording:
    """A recording at a place."""
    recorder = RecordingWriter(path, RecordingMetadata(title="shared-group", clock="virtual"))
    recorder.take(chance.choice(RUNS))
    recorder.close()
    return read(path)


WITHOUT_ENGINE: dict[str, Begin] = {
    "menu": _menu,
    "lesson": _lesson,
    "ASCII lesson": _ascii_lesson,
    "file": _file,
    "recording": _recording,
    "comparison": _comparison,
}
WITH_ENGINE: dict[str, Begin] = {
    "menu with engines": _menu_with_engines,
    "lesson with engine": _lesson_with_engine,
    "file with engine": _file_with_engine,
}
