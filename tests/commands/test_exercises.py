"""An exercise on the command line: begun in a file of one's own, checked, and forgotten again."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from cbtui import cli
from cbtui.learning import exercise_files
from cbtui.runs.judged.checking import observe
from cbtui.runs.setup.lesson_setup import setup_to_judge
from lessons.progress import Progress
from tests.commands.exercise_files import (
    A_GIGABYTE,
    ENDLESS_CALLBACK,
    ENDLESS_MAIN,
    LEAVES,
    LESSON,
    NEVER_SPINS,
    SOLUTION,
    STARTER,
    SYNTAX_ERROR,
)
from tests.support.daily import first_daily, first_row_daily


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Work in an empty folder, with a progress of its own."""
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    folder = tmp_path / "work"
    folder.mkdir()
    monkeypatch.chdir(folder)
    return folder


@pytest.fixture
def refused(capsys: pytest.CaptureFixture[str]) -> "Refused":
    return Refused(capsys)


class Refused:
    """What a command says that ends with 2."""

    def __init__(self, capsys: pytest.CaptureFixture[str]) -> None:
        self._capsys = capsys

    def __call__(self, *words: str) -> str:
        with pytest.raises(SystemExit) as caught:
            cli.main(words)
        assert caught.value.code == 2
        said = self._capsys.readouterr()
        assert said.out == ""
        (line,) = said.err.splitlines()
        return line


def test_start_puts_the_starter_here_and_says_what_is_asked(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(["start", "split-groups"]) == 0
    assert (here / "split_groups.py").read_text() == STARTER
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "split_groups.py is yours now."
    assert lines[-2:] == [
        "In the console: cbtui open split-groups --exercise",
        "Then: cbtui check split-groups",
    ]
    assert all(len(line) <= 79 for line in lines)


def test_start_puts_the_starter_into_a_folder(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (here / "mine").mkdir()
    assert cli.main(["start", "split-groups", "mine"]) == 0
    assert (here / "mine" / "split_groups.py").read_text() == STARTER
    said = capsys.readouterr().out
    assert "Then: cbtui check split-groups mine/split_groups.py" in said
    assert "In the console" not in said


def test_only_a_lesson_with_an_exercise_opens_on_it(refused: "Refused") -> None:
    assert "the lesson single-thread has no exercise" in refused("open", "single-thread", "--exercise")


def test_an_exercise_is_opened_as_the_file_says(refused: "Refused", here: Path) -> None:
    assert "change that" in refused("open", "split-groups", "--exercise", "--threads", "2")
    assert not list(here.iterdir())


def test_start_leaves_an_unchanged_file_and_says_so(capsys: pytest.CaptureFixture[str]) -> None:
    assert [cli.main(["start", "split-groups"]) for _ in range(2)] == [0, 0]
    assert "split_groups.py is there already, unchanged." in capsys.readouterr().out


def test_start_never_writes_over_a_changed_file(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (here / "split_groups.py").write_text("mine")
    assert cli.main(["start", "split-groups"]) == 2
    assert (here / "split_groups.py").read_text() == "mine"
    assert "split_groups.py is there already, and is not as it was put there" in capsys.readouterr().err


def test_start_writes_through_no_dangling_link(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (here / "split_groups.py").symlink_to(here / "elsewhere.py")
    assert cli.main(["start", "split-groups"]) == 2
    assert not (here / "elsewhere.py").exists()
    assert len(capsys.readouterr().err.splitlines()) == 1


def test_start_says_when_a_folder_takes_no_files(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(exercise_files, "write_atomically", refuse)
    assert cli.main(["start", "split-groups"]) == 2
    assert capsys.readouterr().err == "cbtui: split_groups.py cannot be written: Permission denied\n"


def test_start_leaves_no_half_of_a_file(
    here: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    assert cli.main(["start", "split-groups"]) == 2
    assert capsys.readouterr().err == "cbtui: split_groups.py cannot be written: No space left on device\n"
    assert not list(here.iterdir())


def test_start_says_when_there_is_no_folder(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["start", "split-groups", "nowhere"]) == 2
    assert capsys.readouterr().err == "cbtui: there is no folder nowhere\n"


@pytest.mark.parametrize("command", ["start", "check"])
def test_a_lesson_without_an_exercise_is_refused_in_one_line_with_what_shows_the_others(
    refused: Refused, command: str
) -> None:
    assert refused(command, "single-thread").strip() == (
        "cbtui: the lesson single-thread has no exercise; cbtui list shows which lessons have one"
    )


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["start", "split-group"], "no lesson is called 'split-group'; the nearest is 'split-groups'"),
        (["check", "split-group"], "no lesson is called 'split-group'"),
        (["reset", "split-group"], "no lesson is called 'split-group'"),
        (
            ["check", "split-groups"],
            "there is no split_groups.py here; name your file, or begin one with cbtui start",
        ),
        (["check", "split-groups", "gone.py"], "there is no file gone.py"),
        (["check", "gone.py"], "there is no file gone.py"),
        (["check", "split-groups", "."], ". is a folder; name the file in it"),
        (["check", "split-groups", "--limit", "0"], "a run cannot last 0 seconds"),
        (["--lessons", "nowhere", "check", "split-groups"], "there is no folder nowhere"),
    ],
)
def test_a_wrong_command_is_refused_in_one_line(refused: Refused, words: list[str], sentence: str) -> None:
    assert sentence in refused(*words)


def test_check_prints_each_check_and_ends_with_1_until_all_pass(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (here / "split_groups.py").write_text(STARTER)
    assert cli.main(["check", "split-groups"]) == 1
    lines = capsys.readouterr().out.splitlines()
    assert lines[:2] == [
        "✗ /odom keeps coming while the robot rotates",
        "    expected at least 15 calls a second; saw 0 calls in 10 s, at 4.000 s",
    ]
    assert "1 of 5 checks passed" in lines
    assert "  ! odom_callback and scan_callback waited up to 20.0 s: group A was held by" in lines
    assert all(len(line) <= 79 for line in lines)
    assert not Progress().of("split-groups").passed


def test_check_ends_with_0_when_all_pass_and_remembers_that(
    here: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    (here / "my_own.py").write_text(SOLUTION)
    assert cli.main(["check", "split-groups", "my_own.py"]) == 0
    told = capsys.readouterr()
    assert told.out.splitlines()[-1] == "5 of 5 checks passed"
    shown = [line.removeprefix("\033[K") for line in told.err.split("\r")]
    assert shown[:2] == ["", "my_own.py runs: 0.0 s of 30 s"]
    assert shown[-2:] == ["my_own.py runs: 30.0 s of 30 s", ""]
    assert Progress().of("split-groups").passed


def test_a_file_that_is_named_after_its_lesson_is_checked_and_another_one_needs_its_lesson(
    here: Path, capsys: pytest.CaptureFixture[str], refused: Refused
) -> None:
    (here / "my_own.py").write_text(STARTER)
    told = refused("check", "my_own.py")
    assert "cbtui check LESSON my_own.py; " in told
    assert told.endswith("what goes wrong in a node of your own is told by cbtui run my_own.py")
    (here / "split_groups.py").write_text(STARTER)
    assert cli.main(["check", "./split_groups.py"]) == 1
    assert "1 of 5 checks passed" in capsys.readouterr().out.splitlines()


def test_reset_forgets_a_lesson_and_leaves_its_file(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    cli.main(["start", "split-groups"])
    Progress().passes("split-groups")
    capsys.readouterr()
    assert [cli.main(["reset", "split-groups"]) for _ in range(2)] == [0, 0]
    said = capsys.readouterr().out
    assert said == "split-groups starts afresh.\nsplit-groups had not been started.\n"
    assert not Progress().of("split-groups").passed
    assert (here / "split_groups.py").exists()


def test_reset_says_when_it_cannot_be_kept(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "state").touch()
    assert cli.main(["reset", "split-groups"]) in {0, 1}
    Progress().passes("split-groups")
    assert cli.main(["reset", "split-groups"]) == 1
    assert "cannot be read: Not a directory" in capsys.readouterr().err


@pytest.mark.slow
def test_check_writes_plain_characters_where_the_terminal_has_no_others(here: Path) -> None:
    (here / "split_groups.py").write_text(STARTER)
    done = subprocess.run(
        [sys.executable, "-m", "cbtui", "check", "split-groups"],
        capture_output=True,
        check=False,
        env={"PYTHONIOENCODING": "ascii", "XDG_STATE_HOME": str(here)},
    )
    assert done.returncode == 1
    assert done.stderr == b""
    assert done.stdout.isascii()
    assert done.stdout.startswith(b"x /odom keeps coming")
    assert b"\n+ timer_callback never" in done.stdout


@pytest.mark.parametrize(
    ("source", "sentence"),
    first_row_daily(
        (SYNTAX_ERROR, "split_groups.py:28: expected ':'"),
        (
            LEAVES,
            "split_groups.py ended its whole process at 0.000 s: the program ended its process by "
            "os._exit(), with exit code 3",
        ),
        (A_GIGABYTE, "split_groups.py wrote more than 32 MB of log by 0.000 s"),
        ("raise RuntimeError('no')\n", "split_groups.py:1: the program raised RuntimeError: no"),
        ("", "split_groups.py defines no main() and runs nothing at its top level"),
        ("\0", "split_groups.py is not a Python file: it has null bytes in it"),
    ),
    ids=["syntax", "exit", "log", "raises", "empty", "null"],
)
def test_a_file_that_is_no_use_gets_one_clear_line(
    here: Path, capsys: pytest.CaptureFixture[str], source: str, sentence: str
) -> None:
    (here / "split_groups.py").write_text(source)
    assert cli.main(["check", "split-groups"]) == 1
    said = capsys.readouterr()
    assert said.out == ""
    (line,) = said.err.splitlines()
    assert line.startswith(f"cbtui: {sentence}")
    assert (here / "split_groups.py").read_text() == source


@pytest.mark.parametrize("source", first_daily(ENDLESS_MAIN, ENDLESS_CALLBACK), ids=["main", "callback"])
def test_an_endless_loop_is_cut_off(here: Path, capsys: pytest.CaptureFixture[str], source: str) -> None:
    (here / "split_groups.py").write_text(source)
    assert cli.main(["check", "split-groups", "--limit", "2"]) == 1
    said = capsys.readouterr()
    assert said.out == ""
    sentence = "cbtui: split_groups.py was given 2 s of real time, and had not come further than "
    assert said.err.startswith(sentence)


@pytest.mark.slow
def test_a_node_that_never_spins_fails_every_check_it_would_have_to_run_for(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (here / "split_groups.py").write_text(NEVER_SPINS)
    assert cli.main(["check", "split-groups"]) == 1
    assert "0 of 5 checks passed" in capsys.readouterr().out


def test_a_program_that_ends_early_is_said_to_have_ended(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (here / "split_groups.py").write_text("import rclpy\nrclpy.init()\n")
    assert cli.main(["check", "split-groups"]) == 1
    assert "  ! the run was over at 0.000 s: the program returned" in capsys.readouterr().out


def test_a_file_that_is_deleted_before_it_runs_is_named(here: Path) -> None:
    observed = observe(setup_to_judge(LESSON, here / "split_groups.py"), "split_groups.py")
    assert observed.trouble is not None
    assert observed.trouble.startswith("split_groups.py")
    assert "\n" not in observed.trouble


def test_a_learners_file_runs_with_its_own_number_of_threads(here: Path) -> None:
    assert setup_to_judge(LESSON, here / "mine.py").threads is None
