import json
from pathlib import Path

import pytest

import sim.engine
from cbtui.widgets.code.source_files import SourceFiles


@pytest.fixture
def main(tmp_path: Path) -> Path:
    path = tmp_path / "node.py"
    path.write_text("main = 1\n")
    return path


@pytest.fixture
def other(tmp_path: Path) -> Path:
    path = tmp_path / "other.py"
    path.write_text("other = 1\n")
    return path


def test_a_callback_of_another_file_is_found_there(main: Path, other: Path) -> None:
    found = SourceFiles(main).of(str(other))
    assert found is not None
    assert (found.path, found.text) == (other, "other = 1\n")


def test_a_file_is_the_same_whatever_its_path_looks_like(main: Path) -> None:
    files = SourceFiles(main)
    assert files.of(str(main.parent / "." / ".." / main.parent.name / "node.py")) is files.main
    assert files.of("node.py") is files.main


def test_files_of_ours_and_of_libraries_are_not_the_learners(main: Path) -> None:
    files = SourceFiles(main)
    for file in (sim.engine.__file__, json.__file__, pytest.__file__):
        assert file is not None
        assert Path(file).is_file()
        assert files.of(file) is None


def test_a_file_that_is_not_there_is_no_file(main: Path, tmp_path: Path) -> None:
    files = SourceFiles(main)
    assert [
        files.of(file) for file in ("", "gone.py", str(tmp_path / "gone.py"), "/a\0b", str(tmp_path))
    ] == [None] * 5


def test_a_recording_shows_what_was_recorded_and_not_what_lies_there_now(main: Path, other: Path) -> None:
    recorded = {str(other): "other = 'then'\n"}
    files = SourceFiles(main, "main = 'then'\n", recorded)
    found = files.of(str(other))
    assert found is not None
    assert (files.main.text, found.text) == ("main = 'then'\n", "other = 'then'\n")
    assert not files.main.has_changed()
    assert not found.has_changed()


def test_a_source_that_comes_later_in_a_recording_is_found(main: Path) -> None:
    recorded: dict[str, str] = {}
    files = SourceFiles(main, "main = 'then'\n", recorded)
    assert files.of("/far/away.py") is None
    recorded["/far/away.py"] = "far = 1\n"
    found = files.of("/far/away.py")
    assert found is not None
    assert found.text == "far = 1\n"


def test_a_file_has_changed_when_its_text_is_another(main: Path) -> None:
    files = SourceFiles(main)
    main.write_text("main = 1\n")
    assert not files.main.has_changed()
    main.write_text("main = 2\n")
    assert files.main.has_changed()


def test_a_file_that_is_gone_has_not_changed_and_stays_as_it_was(main: Path) -> None:
    files = SourceFiles(main)
    main.unlink()
    assert not files.main.has_changed()
    files.read_anew({})
    assert files.main.text == "main = 1\n"


def test_files_are_read_anew_for_another_run(main: Path, other: Path) -> None:
    files = SourceFiles(main)
    files.of(str(other))
    main.write_text("main = 2\n")
    other.write_text("other = 2\n")
    files.read_anew({})
    found = files.of(str(other))
    assert found is not None
    assert (files.main.text, found.text) == ("main = 2\n", "other = 2\n")
    assert files.of(str(main)) is files.main
