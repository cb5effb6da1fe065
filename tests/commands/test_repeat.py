"""Repeating recorded runs and comparing runs, from the command line."""

from pathlib import Path

import pytest

from cbtui import cli
from cbtui.runs.recorded.recording_file import about
from cbtui.runs.recorded.repeat import CannotRepeatError, repeated_setup
from cbtui.runs.setup.lesson_setup import RunRequest
from sim.engine.setup import ProgramSetup, RunSetup
from tests.recording.files import write
from tests.support.commands import cbtui
from tests.trace.samples import FULL


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where ``run.mcap`` and ``run.jsonl`` tell of a run of three seconds with a call and a line."""
    folder = tmp_path_factory.mktemp("repeat")
    files = ["--record", str(folder / "run.mcap"), "--events", str(folder / "run.jsonl")]
    given = ["--for", "3", "--call", "1.2", "--at", "1.2", "ros2 topic list"]
    done = cbtui("run", "exclusive-2-threads", *given, *files)
    assert done.returncode == 0, done.stderr
    return folder


def test_a_repeated_run_has_the_recorded_events_byte_for_byte(folder: Path) -> None:
    again = folder / "again.jsonl"
    done = cbtui("run", "--inputs", str(folder / "run.mcap"), "--events", str(again))
    assert done.returncode == 0, done.stderr
    assert again.read_bytes() == (folder / "run.jsonl").read_bytes()


def test_a_recording_compared_with_its_lesson_shows_the_same_twice(folder: Path) -> None:
    done = cbtui("compare", str(folder / "run.mcap"), "exclusive-2-threads", "--call", "1.2")
    assert done.returncode == 0, done.stderr
    rows = [line for line in done.stdout.splitlines() if line.startswith("  ") and "run A" not in line]
    assert len(rows) > 8
    assert all(line.endswith("same") for line in rows)


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["run"], "run needs a LESSON or a FILE.py"),
        (["run", "--inputs", "/no.mcap"], "/no.mcap cannot be read: No such file or directory"),
        (["run", "--inputs", "x.mcap", "--clock", "real"], "only runs on the virtual clock can be repeated"),
        (["run", "--inputs", "x.mcap", "--call", "1"], "leave out --call, --at and --type"),
        (["compare", "/no.mcap", "single-thread"], "/no.mcap cannot be read: No such file or directory"),
        (["compare", "/no.py", "single-thread"], "there is no file /no.py"),
        (["compare", "no-lesson", "single-thread"], "no lesson is called 'no-lesson'"),
        (
            ["compare", "single-thread", "split-groups", "--from", "9", "--to", "3"],
            "nothing is left to compare",
        ),
    ],
)
def test_what_cannot_be_repeated_or_compared_is_refused_in_one_sentence(
    words: list[str], sentence: str, capsys: pytest.CaptureFixture[str]
) -> None:
    try:
        code = cli.main(words)
    except SystemExit as left:
        code = int(str(left.code))
    told = capsys.readouterr()
    assert (code, told.out) == (2, "")
    assert sentence in told.err
    assert len(told.err.splitlines()) == 1


def recording_of(folder: Path, clock: str, program: Path) -> Path:
    setup = RunSetup(title="run", programs=(ProgramSetup(str(program)),), clock=clock)
    write(folder / "run.mcap", FULL, about(setup))
    return folder / "run.mcap"


def refusal(path: Path, capsys: pytest.CaptureFixture[str]) -> str:
    with pytest.raises(SystemExit, match="2"):
        cli.main(["run", "--inputs", str(path)])
    return capsys.readouterr().err


def test_a_run_on_the_real_clock_cannot_be_repeated(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    said = refusal(recording_of(tmp_path, "real", tmp_path / "node.py"), capsys)
    assert "is of a real-clock run; only virtual runs can be repeated exactly" in said


def test_a_program_is_as_it_was_whatever_its_line_ends_and_coding(tmp_path: Path) -> None:
    for source in (b"x = 1\r\ny = 2\r\n", b"# -*- coding: latin-1 -*-\nx = '\xe9'\n"):
        (tmp_path / "node.py").write_bytes(source)
        (tmp_path / "run.mcap").unlink(missing_ok=True)
        path = recording_of(tmp_path, "virtual", tmp_path / "node.py")
        repeated_setup(path, RunRequest(), tell=pytest.fail)
    (tmp_path / "node.py").write_bytes(b"x = 1\ny = 2\n")
    (tmp_path / "run.mcap").unlink()
    path = recording_of(tmp_path, "virtual", tmp_path / "node.py")
    (tmp_path / "node.py").write_bytes(b"x = 1\r\ny = 2\r\n")
    with pytest.raises(CannotRepeatError, match="has changed since it was recorded"):
        repeated_setup(path, RunRequest(), tell=pytest.fail)


def test_inputs_that_may_be_missing_are_told_of(tmp_path: Path) -> None:
    (tmp_path / "node.py").touch()
    path = recording_of(tmp_path, "virtual", tmp_path / "node.py")
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    told: list[str] = []
    repeated_setup(path, RunRequest(), tell=told.append)
    (sentence,) = told
    assert sentence.startswith(f"{path}: it breaks off at byte ")


def test_a_program_that_is_gone_cannot_be_repeated(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    said = refusal(recording_of(tmp_path, "virtual", tmp_path / "node.py"), capsys)
    assert "node.py is not there any more; name the file that is to run instead" in said


def test_a_program_that_is_not_repeatable_says_so_for_seeds_inputs_and_orders(tmp_path: Path) -> None:
    program, recording = tmp_path / "program.py", tmp_path / "run.mcap"
    program.write_text("import subprocess\nsubprocess.run(['sleep', '0.1'])\n", encoding="utf-8")
    short = ["--for", "5", "--no-robot"]
    seeded = cbtui("run", str(program), "--seed", "3", "--record", str(recording), *short)
    assert "program.py:2, in <module>: subprocess starts a process" in seeded.stderr
    assert "this program is not repeatable: seed 3 orders its threads, and nothing else" in seeded.stderr
    again = cbtui("run", "--inputs", str(recording))
    assert f"{recording} is of a program that is not repeatable (program.py:2" in again.stderr
    assert again.returncode == 0
    orders = cbtui("explore", str(program), "--schedules", "1", "--for", "5")
    assert "This program is not repeatable: a seed orders its threads" in orders.stdout
