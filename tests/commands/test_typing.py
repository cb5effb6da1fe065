"""``cbtui run`` with a program that reads: its terminal, a pipe or ``--type`` is the keyboard."""

import os
import re
import select
import signal
import subprocess
import sys
import termios
import time
from pathlib import Path
from typing import Any

import pytest

from cbtui.cli import main
from tests.support.daily import first_daily
from tests.support.pseudo_terminal import start_in_terminal
from tests.support.teleop import ASKING, TELEOP

PATIENCE = 60.0


class Typist:
    """Sits at a terminal in which a program runs."""

    def __init__(self, tmp_path: Path, source: str, *options: str) -> None:
        path = tmp_path / "node.py"
        path.write_text(source)
        words = ["-m", "cbtui", "run", str(path), "--no-robot", *options]
        self.process, self._far, self.near = start_in_terminal(words, 80, 24, tmp_path)
        self.usual = self.modes
        self.text = ""

    @property
    def modes(self) -> list[Any]:
        return termios.tcgetattr(self.near)

    def type(self, text: str) -> None:
        os.write(self._far, text.encode())

    def sees(self, pattern: str) -> None:
        deadline = time.monotonic() + PATIENCE
        while (found := re.search(pattern, self.text)) is None:
            assert time.monotonic() < deadline, self.text
            if select.select([self._far], [], [], 0.1)[0]:
                self.text += os.read(self._far, 4096).decode()
        self.text = self.text[found.end() :]

    def asks_for_keys(self) -> None:
        """Wait until the program waits for the next key: between two the terminal is as it was."""
        deadline = time.monotonic() + PATIENCE
        while self.modes == self.usual:
            assert time.monotonic() < deadline
            time.sleep(0.01)

    def leaves(self) -> int:
        deadline = time.monotonic() + PATIENCE
        while self.process.poll() is None and time.monotonic() < deadline:
            if select.select([self._far], [], [], 0.1)[0]:
                self.text += os.read(self._far, 4096).decode()
        assert self.modes == self.usual
        return self.process.wait(1)


@pytest.mark.slow
def test_keys_drive_a_teleop_program_and_ctrl_c_is_one_of_them(tmp_path: Path) -> None:
    typist = Typist(tmp_path, TELEOP)
    typist.sees("CTRL-C quits")
    for key, answer in (("w", "linear 0.02, angular 0.00"), ("a", "linear 0.02, angular 0.20")):
        typist.type(key)
        typist.sees(answer)
    typist.type("\x03")
    typist.sees("the program returned")
    assert typist.leaves() == 0


@pytest.mark.slow
def test_a_line_is_asked_for_at_once_and_ctrl_c_ends_the_run(tmp_path: Path) -> None:
    typist = Typist(tmp_path, ASKING)
    typist.sees(r"speed\? $")
    typist.type("0.5\n")
    typist.sees(r"0\.5\r\nthe speed is 0\.5\r\nspeed\? $")
    typist.type("\x03")
    assert typist.leaves() == 128 + signal.SIGINT


@pytest.mark.slow
@pytest.mark.parametrize("ending", first_daily("kill", "ctrl-c twice"))
def test_the_terminal_is_left_as_it_was(tmp_path: Path, ending: str) -> None:
    typist = Typist(tmp_path, "import sys, tty\ntty.setraw(0)\nwhile True:\n    print(sys.stdin.read(1))\n")
    typist.type("x")
    typist.sees("x\r\n")
    typist.asks_for_keys()
    if ending == "kill":
        typist.process.terminate()
        assert typist.leaves() == 128 + signal.SIGTERM
    else:
        typist.type("\x03")
        typist.sees("\r\n")
        typist.type("\x03")
        assert typist.leaves() == 128 + signal.SIGINT


@pytest.mark.slow
def test_what_comes_through_a_pipe_is_what_is_typed_and_its_end_is_the_inputs(tmp_path: Path) -> None:
    path = tmp_path / "node.py"
    path.write_text(ASKING)
    command = [sys.executable, "-m", "cbtui", "run", str(path), "--clock", "virtual", "--no-robot"]
    ran = subprocess.run(command, input="1\n2\n", capture_output=True, text=True, check=False)
    assert ran.returncode == 1
    assert "speed? the speed is 1.0\nspeed? the speed is 2.0\nspeed? \n" in ran.stdout
    assert "EOFError" in ran.stderr


def test_a_run_that_was_typed_to_is_repeated(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, events = tmp_path / "node.py", [tmp_path / "first.jsonl", tmp_path / "again.jsonl"]
    path.write_text(TELEOP)
    options = ["--clock", "virtual", "--for", "3", "--no-robot", "--type", "1", "ww", "--type", "2", r"\x03"]
    recording = tmp_path / "run.mcap"
    assert main(["run", str(path), *options, "--events", str(events[0]), "--record", str(recording)]) == 0
    assert "linear 0.04, angular 0.00\n" in capsys.readouterr().out
    assert main(["run", "--inputs", str(recording), "--events", str(events[1])]) == 0
    assert events[0].read_bytes() == events[1].read_bytes()
    assert '"event":"typed","message":"ww"' in events[0].read_text()


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (["--type", "70", "w"], "a key at 70 s comes when the run of 60 s is over"),
        (["--type", "1", "w\\"], "ends in the middle of an escape"),
        (["--type", "1", "w", "--inputs", "run.mcap"], "leave out --call, --at and --type"),
    ],
)
def test_what_cannot_be_typed_is_refused(
    options: list[str], sentence: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit):
        main(["run", "shared-group", *options])
    assert sentence in capsys.readouterr().err
