"""Lessons by others on the command line: made, proved, and brought in."""

import os
from pathlib import Path

import pytest

from cbtui import cli
from cbtui.app import CbtuiApp
from cbtui.commands.console import run_console
from cbtui.commands.options.appearance import Appearance
from cbtui.keys.keymap import Keymap
from cbtui.looks.colour_themes import STANDARD


def test_a_new_node_runs_well_and_is_never_written_over(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "my own" / "node.py"
    file.parent.mkdir()
    assert cli.main(["new", str(file)]) == 0
    assert f"See it run: cbtui open '{file}'\n" in capsys.readouterr().out
    assert cli.main(["run", str(file), "--clock", "virtual", "--for", "5", "--call", "2"]) == 0
    told = capsys.readouterr().out
    assert "longest waits: none" in told
    assert "answered after 2.0 s" in told
    file.write_text("mine\n")
    with pytest.raises(SystemExit, match="2"):
        cli.main(["new", str(file)])
    assert file.read_text() == "mine\n"


@pytest.mark.parametrize(
    ("name", "sentence"),
    [
        ("mine.txt", "mine.txt is not the name of a program: give one that ends in .py"),
        ("class.py", "class.py could not be imported"),
        ("1a.py", "1a.py could not be imported"),
        ("my-node.py", "my-node.py could not be imported"),
        ("rclpy.py", "rclpy.py would hide the module rclpy from every program beside it: take another name"),
        ("std_msgs.py", "would hide the module std_msgs"),
        ("tf2_ros.py", "would hide the module tf2_ros"),
        ("threading.py", "would hide the module threading"),
        ("numpy.py", "would hide the module numpy"),
    ],
)
def test_a_name_that_no_program_can_have_is_refused(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    name: str,
    sentence: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit, match="2"):
        cli.main(["new", name])
    (line,) = capsys.readouterr().err.splitlines()
    assert sentence in line
    assert not list(tmp_path.iterdir())


def test_a_new_lesson_is_right_as_it_is(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "more" / "two-belts"
    assert cli.main(["new-lesson", str(folder)]) == 0
    assert f"Prove it: cbtui lint-lesson {folder}\n" in capsys.readouterr().out
    assert cli.main(["lint-lesson", str(tmp_path / "more")]) == 0
    assert capsys.readouterr().out == f"{folder}: all is as it says\n"


def test_a_new_lesson_is_listed_begun_and_found_among_the_others(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    cli.main(["new-lesson", "two-belts"])
    capsys.readouterr()
    assert cli.main(["--lessons", ".", "list"]) == 0
    assert capsys.readouterr().out.splitlines()[-1].split()[1:4] == ["two-belts", "Two", "belts:"]
    assert cli.main(["start", "two-belts", "--lessons", "two-belts"]) == 0
    assert (tmp_path / "two_belts.py").is_file()
    assert "CBTUI_LESSONS" not in os.environ


def test_lint_lesson_tells_every_fault_and_ends_with_1(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "two-belts"
    cli.main(["new-lesson", str(folder)])
    (folder / "guide.md").unlink()
    capsys.readouterr()
    assert cli.main(["lint-lesson", str(folder)]) == 1
    assert capsys.readouterr().out == f"{folder}/lesson.toml: there is no file 'guide.md' beside it\n"


def test_a_folder_that_is_no_lesson_is_said_to_be_none(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(["lint-lesson", str(tmp_path)]) == 1
    assert capsys.readouterr().out == f"{tmp_path}/lesson.toml: cannot be read: No such file or directory\n"


@pytest.mark.parametrize(
    ("name", "sentence"),
    [
        ("Two Belts", "'Two Belts' cannot be a lesson's id; take small letters and digits, joined by '-'"),
        ("there", "there is there already; nothing was written"),
        ("split-groups", "cbtui has a lesson 'split-groups' already; take another name"),
        ("file/new", "cannot be made: Not a directory"),
    ],
)
def test_a_lesson_that_cannot_be_made_is_said_to_be_so(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str, sentence: str
) -> None:
    (tmp_path / "there").mkdir()
    (tmp_path / "file").touch()
    assert cli.main(["new-lesson", str(tmp_path / name)]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert sentence in line
    assert list((tmp_path / "there").iterdir()) == []


def test_a_lesson_that_is_not_whole_is_not_left_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def full(_source: Path, target: Path) -> None:
        target.touch()
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("shutil.copyfile", full)
    assert cli.main(["new-lesson", str(tmp_path / "new")]) == 2
    assert "new cannot be made: No space left on device" in capsys.readouterr().err
    assert not (tmp_path / "new").exists()


@pytest.fixture
def fault(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> str:
    """The sentence on the lesson two-belts in the temporary folder, which lacks its node."""
    folder = tmp_path / "two-belts"
    cli.main(["new-lesson", str(folder)])
    (folder / "node.py").unlink()
    capsys.readouterr()
    place = f"{folder}/lesson.toml:12"
    return f"cbtui: {place}: the field 'setup.node' is wrong: there is no file 'node.py' beside it\n"


@pytest.mark.parametrize("command", ["open", "run", "start"])
def test_a_lesson_at_fault_is_refused_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], command: str, fault: str
) -> None:
    with pytest.raises(SystemExit, match="2"):
        cli.main([command, "two-belts", "--lessons", str(tmp_path)])
    assert capsys.readouterr().err == fault


def test_the_list_names_a_lesson_at_fault_after_the_others(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], fault: str
) -> None:
    assert cli.main(["list", "--lessons", str(tmp_path)]) == 0
    out, err = capsys.readouterr()
    assert err == fault
    assert "single-thread" in out
    assert "two-belts" not in out


def test_another_lesson_is_begun_beside_one_at_fault(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, fault: str
) -> None:
    monkeypatch.chdir(tmp_path)
    assert cli.main(["start", "split-groups", "--lessons", "."]) == 0
    assert capsys.readouterr().err == ""


def test_the_console_begins_with_the_sentence_on_a_lesson_at_fault(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, fault: str
) -> None:
    shown: list[str] = []

    def run(app: CbtuiApp) -> None:
        shown.extend(app._complaints)

    monkeypatch.setattr(CbtuiApp, "run", run)
    monkeypatch.setenv("CBTUI_LESSONS", str(tmp_path))
    run_console(Appearance("block", "auto", STANDARD, Keymap(), ["The colour is unknown."]))
    assert shown == ["The colour is unknown.", fault.removeprefix("cbtui: ").rstrip()]


def test_lessons_of_nowhere_are_refused(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit, match="2"):
        cli.main(["lint-lesson", "/no/such/folder"])
    assert capsys.readouterr().err == "cbtui: there is no folder /no/such/folder\n"
