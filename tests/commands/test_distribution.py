"""What is built to be installed: the wheel has all that runs, the source distribution all that tests need."""

import subprocess
import sys
import zipfile
from collections import Counter
from collections.abc import Iterable
from pathlib import Path

import pytest
from hatchling.builders.sdist import SdistBuilder

_ROOT = Path(__file__).parents[2]
_PACKAGES = ("cbtui", "lessons", "sim")
_NEVER = (".pyc", ".mcap")
"""What the endings are of files that running leaves behind."""
_PICTURE = "cbtui/screen.svg"
"""The README's picture, which only the repository needs."""
_FOR_READERS = ("README.md", "EVENTS.md", "ruff.toml")
"""What the pages on rooms and events, and the settings of the lessons' linter, are named."""
_BUILD = "import sys; from hatchling import build; print(build.build_wheel(sys.argv[1]))"


def _built_wheel(folder: Path) -> Path:
    command = [sys.executable, "-c", _BUILD, str(folder)]
    done = subprocess.run(command, cwd=_ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return folder / done.stdout.split()[-1]


def _files(folders: Iterable[str]) -> set[str]:
    every = (path for folder in folders for path in (_ROOT / folder).rglob("*") if path.is_file())
    return {
        path.relative_to(_ROOT).as_posix()
        for path in every
        if path.suffix not in _NEVER and "__pycache__" not in path.parts
    }


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return _built_wheel(tmp_path_factory.mktemp("wheel"))


@pytest.fixture(scope="module")
def wheel(built: Path) -> set[str]:
    with zipfile.ZipFile(built) as file:
        return set(file.namelist())


def test_the_wheel_is_small(built: Path) -> None:
    assert built.stat().st_size < 2_000_000


def test_the_wheel_has_every_file_but_what_only_readers_need_and_nothing_else(wheel: set[str]) -> None:
    own = {name for name in wheel if ".dist-info/" not in name}
    assert own == {name for name in _files(_PACKAGES) - {_PICTURE} if Path(name).name not in _FOR_READERS}


def test_the_wheel_has_what_is_no_python_too(wheel: set[str]) -> None:
    kinds = Counter(Path(name).suffix for name in wheel)
    kinds_needed = {".toml", ".md", ".tcss", ".urdf", ".interfaces", ".html", ".xml", ".typed"}
    assert kinds_needed <= set(kinds)
    assert {f"{package}/py.typed" for package in _PACKAGES} < wheel
    launch_files = {name for name in wheel if ".launch." in name}
    assert (
        launch_files == {name for name in _files(["lessons", "sim", "cbtui"]) if ".launch." in name} != set()
    )


def test_the_wheel_brings_the_command_and_the_licence(wheel: set[str]) -> None:
    assert any(name.endswith(".dist-info/entry_points.txt") for name in wheel)
    assert any(name.endswith("/LICENSE") for name in wheel)


def test_the_source_distribution_can_run_its_own_tests() -> None:
    included = {file.distribution_path for file in SdistBuilder(str(_ROOT)).recurse_included_files()}
    assert _files((*_PACKAGES, "tests")) <= included
    assert {"README.md", "LICENSE", ".ci/run"} <= included  # and pyproject.toml, which it is built by
