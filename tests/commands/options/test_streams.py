"""Standard streams that are closed, full, or know few signs: the program works, or says one sentence."""

import io
import json
import os
import subprocess
import sys
from pathlib import Path
from queue import Queue
from typing import TextIO

import pytest
from psutil import Process

from cbtui.cli import main
from cbtui.commands.options.targets import need_terminal
from cbtui.runs.headless.program_log import write_line
from cbtui.runs.headless.standard_input import StandardInput
from cbtui.terminal.capabilities import charset_of
from cbtui.text.output import CannotSayError
from sim.engine.commands import TerminalInput
from sim.trace.events import KeyboardAsked, Reading
from tests.support.daily import first_daily

_CBTUI = f"{sys.executable} -m cbtui"


def _shell(line: str, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        ["/bin/sh", "-c", line], capture_output=True, text=True, check=False, env=environment
    )


@pytest.mark.slow
@pytest.mark.parametrize("closed", first_daily("<&- >&- 2>&-", "<&-", ">&-", "2>&-"))
def test_streams_that_are_closed_are_as_if_nobody_read_them(closed: str, tmp_path: Path) -> None:
    events = tmp_path / "events"
    done = _shell(f"{_CBTUI} run single-thread --for 0.2 --events {events} {closed}")
    assert done.returncode == 0, done.stderr
    assert events.read_text().endswith('"failed":false}\n')


def closed_file() -> TextIO:
    with Path(os.devnull).open() as file:
        return file


@pytest.fixture(
    params=[lambda: None, closed_file, lambda: io.StringIO("typed")], ids=["none", "closed", "text"]
)
def nobodys_input(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """A standard input that has no descriptor."""
    monkeypatch.setattr(sys, "stdin", request.param())


@pytest.mark.usefixtures("nobodys_input")
def test_where_standard_input_has_no_descriptor_a_program_that_reads_gets_its_end() -> None:
    given: Queue[TerminalInput] = Queue()
    before = Process().num_fds()
    keyboard = StandardInput(given.put)
    assert not keyboard.is_terminal
    keyboard.follow([KeyboardAsked(0, Reading.LINES, "node.py")])
    assert given.get(timeout=60) == TerminalInput("", ends=True)
    keyboard.close()
    assert Process().num_fds() == before


@pytest.mark.usefixtures("nobodys_input")
def test_a_run_whose_standard_input_has_no_descriptor_comes_to_its_end(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main(["run", "single-thread", "--for", "0.2"]) == 0
    assert "cut short" not in capsys.readouterr().err


@pytest.mark.slow
@pytest.mark.skipif(not Path("/dev/full").exists(), reason="this system has no device that is always full")
def test_an_output_that_is_full_is_told_in_one_sentence(tmp_path: Path) -> None:
    for environment in ({}, {"PYTHONUNBUFFERED": "1"}):
        for command in ("list", "--help", "--version", f"eject {tmp_path}"):
            done = _shell(f"{_CBTUI} {command} >/dev/full", **environment)
            assert done.returncode == 1
            assert done.stderr == "cbtui: its output cannot be written: No space left on device\n"


@pytest.mark.slow
@pytest.mark.skipif(not Path("/dev/full").exists(), reason="this system has no device that is always full")
def test_where_not_even_complaints_can_be_written_the_exit_code_tells() -> None:
    assert _shell(f"{_CBTUI} nonsense 2>/dev/full").returncode == 2
    assert _shell(f"{_CBTUI} list >/dev/full 2>&1").returncode == 1


@pytest.mark.slow
def test_a_reader_who_has_read_enough_is_no_trouble(tmp_path: Path) -> None:
    for command in ("keys", "--help", "--version", f"eject {tmp_path}"):
        done = _shell(f"({_CBTUI} {command}; echo $? >&2) | true")
        assert done.stderr in {"0\n", "141\n"}  # the first words may go out before the reader goes


def test_a_log_that_cannot_be_written_ends_the_run_in_order(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def full(_text: str) -> int:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(sys.stdout, "write", full)
    with pytest.raises(CannotSayError):
        write_line("printed", error=False)
    assert capsys.readouterr().err == ""


@pytest.mark.slow
def test_signs_that_the_encoding_lacks_become_question_marks() -> None:
    done = _shell(f"{_CBTUI} list", PYTHONIOENCODING="ascii")
    assert done.returncode == 0
    assert done.stderr == ""
    run = _shell(f"{_CBTUI} run single-thread --for 1", PYTHONIOENCODING="ascii")
    assert run.returncode == 0, run.stderr
    assert "Traceback" not in run.stderr


def test_the_console_is_not_drawn_where_nobody_sees_it(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys.stdin, "isatty", lambda: True)
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True)
    with pytest.raises(SystemExit):
        need_terminal("cbtui run")
    assert "the console draws on standard error" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("encoding", "charset"),
    [("utf-8", "braille"), ("UTF8", "braille"), ("latin-1", "ascii"), ("ascii", "ascii")],
)
def test_what_python_writes_with_limits_the_signs(encoding: str, charset: str) -> None:
    assert charset_of({"LANG": "C.UTF-8", "TERM": "xterm"}, False, encoding) == charset


@pytest.mark.slow
def test_why_a_run_is_given_up_is_told_once(tmp_path: Path) -> None:
    path = tmp_path / "node.py"
    path.write_text("import time\nwhile True:\n    time.sleep(0)\n")
    done = _shell(f"{_CBTUI} run --clock virtual {path}")
    assert done.returncode == 1
    assert done.stderr.count("time stands still: MainThread (node.py:3, in <module>)") == 1


@pytest.mark.parametrize("option", ["--json", "--events"])
def test_a_dash_is_standard_output_and_only_data_goes_there(option: str, tmp_path: Path) -> None:
    run = f"cd {tmp_path} && {_CBTUI} run single-thread --for 0.2 {option} -"
    piped = _shell(f"{run} | cat")
    assert all(map(json.loads, piped.stdout.splitlines() if option == "--events" else [piped.stdout]))
    assert "\nthreads  1 ran callbacks" in piped.stderr
    (tmp_path / "kept").write_text("earlier\n")
    assert "would be lost" in _shell(f"{run} >> kept").stderr
    assert [path.read_text() for path in tmp_path.iterdir()] == ["earlier\n"]
