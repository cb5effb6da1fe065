"""What is said where a package of somebody else's has the name of one of cbtui's."""

import subprocess
import sys
from pathlib import Path

import pytest

import lessons
from cbtui.text.clashing_packages import on_hidden, on_hiding


@pytest.mark.parametrize("module", ["lessons.mine", "lessons"])
def test_a_package_of_cbtuis_hides_one_for_other_peoples_files_alone(module: str) -> None:
    error = ImportError("no such thing", name=module)
    folder = Path(lessons.__file__).parent
    said = f"{folder} is cbtui's own package lessons, which hides yours; rename yours"
    assert on_hiding(error, Path("/tmp/test_mine.py")) == said
    assert on_hiding(error, Path(__file__)) == ""
    assert on_hidden(error) == ""


def test_other_packages_are_no_clash() -> None:
    error = ModuleNotFoundError("No module named 'numpy.mine'", name="numpy.mine")
    assert on_hiding(error, Path("/tmp/test_mine.py")) == on_hidden(error) == ""


@pytest.mark.parametrize("package", ["lessons", "sim"])
def test_a_command_says_in_a_sentence_which_package_hides_one_of_cbtuis(package: str, tmp_path: Path) -> None:
    hider = tmp_path / package / "__init__.py"
    hider.parent.mkdir()
    hider.touch()
    command = [sys.executable, "-m", "cbtui", "list"]
    ran = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    said = f"cbtui's own package {package} is hidden by {hider}; rename that, or keep it off sys.path"
    assert (ran.returncode, ran.stderr) == (1, f"cbtui: {said}\n")
