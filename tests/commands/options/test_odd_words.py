"""Numbers, names and files that no one means: each is refused in one line, and nothing is run or written."""

import os
from collections.abc import Callable
from pathlib import Path

import pytest

from cbtui import cli
from cbtui.commands.options import inputs
from tests.recording.files import write
from tests.support.runs import shared_group_run

LONG = "x" * 300
"""A name that is too long to be looked for, as a name in somebody else's folder may not be."""
BYTES = "\udc80"
"""What Python makes of a byte on the command line that is no UTF-8."""
NODE = "print('here')\n"

Complaint = Callable[[list[str]], str]


@pytest.fixture
def complaint(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Complaint:
    """Run a command that ends with 2, beside some files that have to stay as they are; its one line."""
    monkeypatch.chdir(tmp_path)
    for name in ("node.py", f"{BYTES}.py", "split_groups.py", "kept.txt"):
        Path(name).write_text(NODE)
    Path("folder").mkdir()
    Path("loop.mcap").symlink_to("loop.mcap")
    os.mkfifo("pipe.py")
    os.mkfifo("pipe.mcap")
    write(tmp_path / "run.mcap", shared_group_run().events)
    before = _contents(tmp_path)

    def refused(words: list[str]) -> str:
        try:
            code = cli.main(words)
        except SystemExit as end:
            code = int(str(end.code))
        said = capsys.readouterr()
        assert (code, said.out) == (2, "")
        assert _contents(tmp_path) == before
        (line,) = said.err.splitlines()
        return line

    return refused


def _contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["run", "node.py", "--for", "1e300"], "no run lasts 1e300 s; give 1000000000 or less"),
        (["run", "node.py", "--call", "1e300"], "no run lasts 1e300 s"),
        (["compare", "run.mcap", "run.mcap", "--from", "1e300"], "no run lasts 1e300 s"),
        (["export", "run.mcap", "--svg", "a", "--to", "1e300"], "no run lasts 1e300 s"),
        (["run", "node.py", "--speed", "1e-300"], "give 0.001 or more, or max"),
        (["run", "node.py", "--seed", "9" * 30], "give 1000000000000000000 or less"),
        (["explore", "node.py", "--schedules", "9" * 30], "are too many at once; give 100000 or fewer"),
        (["explore", "node.py", "--preemptions", "-1"], "-1 is less than none; give 0 or more"),
        (["serve", "--host", ""], "'' is not an address"),
        (["serve", "--public-url", "http://[x"], "'http://[x' is not an address"),
        (["serve", "--public-url", "http://a:99999"], "'http://a:99999' is not an address"),
        (["serve", "--", "--clock", "real"], "cbtui open: the following arguments are required"),
    ],
)
def test_numbers_and_addresses_that_nothing_can_be_done_with(
    complaint: Complaint, words: list[str], sentence: str
) -> None:
    assert sentence in complaint(words)


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["run", f"{LONG}.py"], ".py cannot be opened: File name too long"),
        (["check", "split-groups", f"{LONG}.py"], ".py cannot be opened: File name too long"),
        (["grade", LONG], "x cannot be opened: File name too long"),
        (["lint-lesson", LONG], "x cannot be opened: File name too long"),
        (["--lessons", LONG, "list"], "x cannot be opened: File name too long"),
        (["run", f"{BYTES}.py"], "its name and its folders' names have to be UTF-8"),
        (["run", "node.py", "--", BYTES], "what follows -- has to be text in UTF-8"),
        (["run", "node.py", "--at", "1", BYTES], "'\\udc80' is not UTF-8 text"),
        (["run", "node.py", "--group", f"{BYTES}=own"], "is not a callback and its value"),
        (["ros2", "topic", BYTES], "a ros2 line has to be text in UTF-8"),
        (["run", "pipe.py"], "pipe.py is a pipe or a device; give a file"),
        (["info", "pipe.mcap"], "pipe.mcap is a pipe, and a recording is read back and forth; give a file"),
        (
            ["export", "loop.mcap", "--csv", "a"],
            "loop.mcap cannot be read: Too many levels of symbolic links",
        ),
    ],
)
def test_what_cannot_be_opened(complaint: Complaint, words: list[str], sentence: str) -> None:
    assert sentence in complaint(words)


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["run", "node.py", "--events", "node.py"], "--events would overwrite node.py"),
        (["run", "node.py", "--events", "a", "--record", "a"], "--record would overwrite a"),
        (
            ["run", "--inputs", "run.mcap", "--record", "run.mcap", "--force"],
            "--record would overwrite run.mcap",
        ),
        (["run", "node.py", "--record", "folder"], "folder cannot be written: it is a folder"),
        (
            ["run", "node.py", "--record", "run.mcap", "--events", "new.txt"],
            "there is a file run.mcap already",
        ),
        (["run", "node.py", "--events", "kept.txt"], "there is a file kept.txt already; give another name"),
        (["run", "node.py", "--json", "kept.txt"], "there is a file kept.txt already"),
        (["explore", "node.py", "--save", "kept.txt"], "there is a file kept.txt already"),
        (["export", "run.mcap", "--svg", "kept.txt"], "there is a file kept.txt already"),
        (["grade", ".", "--csv", "kept.txt"], "there is a file kept.txt already"),
        (["grade", ".", "--junit", "kept.txt"], "there is a file kept.txt already"),
        (["grade", ".", "--csv", "new.txt", "--junit", "new.txt"], "--csv would overwrite new.txt"),
        (["run", "node.py", "--force"], "--force replaces files that are there already; no file to write"),
        (
            ["run", "node.py", "--record", "run.mcap", "--force", "--events", "no/x"],
            "no/x cannot be written: there is no folder no",
        ),
        (["export", "run.mcap", "--force", "--csv", "kept.txt", "--svg", "no/x"], "no/x cannot be written"),
        (["export", "run.mcap", "--csv", "new.csv", "--svg", "/dev/full"], "cannot write /dev/full"),
        (["grade", ".", "--csv", "split_groups.py"], "--csv would overwrite split_groups.py"),
        (["grade", ".", "--csv", "folder"], "folder cannot be written: it is a folder"),
    ],
)
def test_nothing_is_overwritten_or_left_half_written(
    complaint: Complaint, words: list[str], sentence: str
) -> None:
    assert sentence in complaint(words)


def test_force_replaces_what_is_there(tmp_path: Path) -> None:
    recording, kept = tmp_path / "run.mcap", tmp_path / "kept.txt"
    write(recording, shared_group_run().events)
    kept.write_text("precious")
    assert cli.main(["export", str(recording), "--csv", str(kept), "--force"]) == 0
    assert kept.read_text().startswith("start_s,")


def test_another_name_of_the_recording_is_no_place_for_its_export(
    complaint: Complaint, tmp_path: Path
) -> None:
    (tmp_path / "folder" / "same.mcap").hardlink_to(tmp_path / "run.mcap")
    assert "--csv would overwrite run.mcap" in complaint(["export", "run.mcap", "--csv", "folder/same.mcap"])


def test_in_a_folder_that_is_gone_one_is_told_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    gone = tmp_path / "gone"
    gone.mkdir()
    monkeypatch.chdir(gone)
    gone.rmdir()
    with pytest.raises(SystemExit, match="2"):
        cli.main(["lint-lesson", "."])
    said = capsys.readouterr().err
    assert said == "cbtui: the current folder cannot be used: No such file or directory; go to another one\n"


def test_folders_of_ones_own_that_cannot_be_looked_into_are_told_of(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("XDG_STATE_HOME", "XDG_CONFIG_HOME"):
        monkeypatch.setenv(name, str(tmp_path / LONG))
    assert cli.main(["reset", "split-groups"]) == 1
    assert "cannot be read: File name too long; progress is not kept" in capsys.readouterr().err
    assert cli.main(["keys"]) == 0
    said = capsys.readouterr()
    assert "config.toml cannot be read: File name too long" in said.err
    assert "[keys]" in said.out


def test_moments_are_said_again_to_the_nanosecond() -> None:
    words = inputs.words([123.456789012], [(1.000000001, "ros2 topic list")])
    assert words == ["--call", "123.456789012", "--at", "1.000000001", "ros2 topic list"]
