"""Standard streams that are closed, full, or know few signs: the program works, or says one sentence."""

import subprocess
import sys
from pathlib import Path

import pytest

from cbtui.commands.targets import need_terminal
from cbtui.terminal import charset_of

_CBTUI = f"{sys.executable} -m cbtui"


def _shell(line: str, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        ["/bin/sh", "-c", line], capture_output=True, text=True, timeout=60, check=False, env=environment
    )


@pytest.mark.parametrize("closed", ["<&-", ">&-", "2>&-", "<&- >&- 2>&-"])
def test_streams_that_are_closed_are_as_if_nobody_read_them(closed: str, tmp_path: Path) -> None:
    events = tmp_path / "events"
    done = _shell(f"{_CBTUI} run single-thread --for 0.2 --events {events} {closed}")
    assert done.returncode == 0, done.stderr
    assert events.read_text().endswith('"failed":false}\n')


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="this system has no device that is always full")
def test_an_output_that_is_full_is_told_in_one_sentence() -> None:
    for environment in ({}, {"PYTHONUNBUFFERED": "1"}):
        done = _shell(f"{_CBTUI} list >/dev/full", **environment)
        assert done.returncode == 1
        assert done.stderr == "cbtui: what it says cannot be written: No space left on device\n"


def test_a_reader_who_has_read_enough_is_no_trouble() -> None:
    done = _shell(f"{_CBTUI} keys | head -n 1")
    assert done.stderr == ""


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
