import os
from pathlib import Path

import pytest

from cbtui.runs.setup.own_files import CannotOpenError, completed, entry_for, read_recording
from cbtui.runs.setup.recent import RecentKind


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for name in ("my_node.py", "my_other.py", "run.mcap", "go.launch.xml", "notes.txt", ".hidden.py"):
        (tmp_path / name).write_text("")
    (tmp_path / "my_pkg").mkdir()
    (tmp_path / "my_pkg" / "node.py").write_text("")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize(
    ("typed", "kind"),
    [
        ("my_node.py", RecentKind.PROGRAM),
        (" ./my_pkg/node.py ", RecentKind.PROGRAM),
        ("go.launch.xml", RecentKind.PROGRAM),
        ("run.mcap", RecentKind.RECORDING),
    ],
)
def test_what_a_path_means_shows_in_its_name(folder: Path, typed: str, kind: RecentKind) -> None:
    entry = entry_for(typed, 7.9)
    assert (entry.kind, entry.what, entry.at) == (kind, str(folder / typed.strip()), 7)


def test_a_home_can_be_written_as_a_tilde(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", str(folder))
    assert entry_for("~/run.mcap", 0).what == str(folder / "run.mcap")
    assert completed("~/ru") == ("~/run.mcap", ["run.mcap"])


@pytest.mark.parametrize(
    ("typed", "part"),
    [
        ("", "Type the path"),
        ("nothing.py", "There is no file nothing.py."),
        ("my_pkg", "is a folder"),
        ("notes.txt", "neither a program"),
        ("a\0b.py", "There is no file"),
        ("n" * 5000 + ".py", "cannot be opened"),
        ("~nobody-at-all/x.py", "There is no file"),
    ],
)
def test_what_cannot_be_opened_gets_one_sentence(folder: Path, typed: str, part: str) -> None:
    with pytest.raises(CannotOpenError) as error:
        entry_for(typed, 0)
    assert part in str(error.value)
    assert "\n" not in str(error.value)


def test_a_pipe_is_no_file_to_open(folder: Path) -> None:
    os.mkfifo(folder / "pipe.py")
    with pytest.raises(CannotOpenError, match="is not a file"):
        entry_for("pipe.py", 0)


def test_a_file_that_is_no_recording_is_said_to_be_none(folder: Path) -> None:
    with pytest.raises(CannotOpenError, match=r"run\.mcap is empty\.$"):
        read_recording(folder / "run.mcap")


@pytest.mark.parametrize(
    ("typed", "text", "names"),
    [
        ("", "", ["go.launch.xml", "my_node.py", "my_other.py", "my_pkg/", "run.mcap"]),
        ("m", "my_", ["my_node.py", "my_other.py", "my_pkg/"]),
        ("my_p", "my_pkg/", ["my_pkg/"]),
        ("my_pkg/", "my_pkg/node.py", ["node.py"]),
        (".h", ".hidden.py", [".hidden.py"]),
        ("no", "no", []),
        ("nowhere/a", "nowhere/a", []),
        ("a\0/b", "a\0/b", []),
    ],
)
def test_a_path_is_completed_as_far_as_it_has_one_way_to_go_on(
    folder: Path, typed: str, text: str, names: list[str]
) -> None:
    found = completed(typed)
    assert (found.text, list(found.names)) == (text, names)
