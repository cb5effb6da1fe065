"""``cbtui replay``: what it refuses, each in one sentence."""

from pathlib import Path

import pytest
from mcap.writer import Writer

from cbtui import cli
from tests.recording.files import write
from tests.support.runs import shared_group_run


def refused(path: Path, capsys: pytest.CaptureFixture[str]) -> str:
    """What is said of a file that is not shown."""
    return refused_by("replay", path, capsys)


def refused_by(command: str, path: Path, capsys: pytest.CaptureFixture[str]) -> str:
    with pytest.raises(SystemExit) as raised:
        cli.main([command, str(path)])
    assert raised.value.code == 2
    told = capsys.readouterr()
    assert told.out == ""
    assert len(told.err.splitlines()) == 1
    return told.err


def test_what_is_no_recording_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = tmp_path / "notes.txt"
    text.write_text("nothing of the kind")
    assert "is not a recording" in refused(text, capsys)
    text.write_text("")
    assert "is empty" in refused(text, capsys)


def test_a_missing_file_and_a_folder_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert "cannot be read: No such file or directory" in refused(tmp_path / "none.mcap", capsys)
    assert "cannot be read: Is a directory" in refused(tmp_path, capsys)


def test_a_recording_of_another_program_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "foreign.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start(profile="ros2", library="other")
        writer.finish()  # type: ignore[no-untyped-call]
    assert "is an MCAP file, but not a recording of cbtui" in refused(path, capsys)


def test_without_a_terminal_another_command_is_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "run.mcap"
    write(path, shared_group_run().events)
    assert "the console needs a terminal; use cbtui info" in refused(path, capsys)


def test_a_recording_is_opened_as_such_and_run_by_no_command(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "run.mcap"
    write(path, shared_group_run().events)
    assert "the console needs a terminal; use cbtui info" in refused_by("open", path, capsys)
    for command in ("run", "check", "explore"):
        told = refused_by(command, path, capsys)
        assert f"{path} is a recording, which nothing runs; cbtui replay {path} shows it" in told
