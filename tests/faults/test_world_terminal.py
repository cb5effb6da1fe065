"""A terminal's window that is closed, and a terminal in which the console is told to hang up."""

import os
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from sim.recording import read
from tests.faults.support import nothing_left
from tests.terminal.console import TerminalConsole, opened

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="processes are looked up in /proc")

_ESCAPE = "\x1b"
"""Out of the question what one expects, without an answer."""
_TAKEN = "\x1b[?1049h"
"""Begins the console's screen, also when it goes on after a stop: keys typed before that are lost."""
_LEFT = "\x1b[?1049l"
"""Leaves the console's screen for the one before, as the terminal is given back."""
HUNG_UP = 128 + signal.SIGHUP
_SHELL = """
import os, signal, sys

child = os.fork()
if not child:
    os.setpgid(0, 0)
    os.execv(sys.executable, [sys.executable, "-m", "cbtui"])
os.waitpid(child, os.WUNTRACED)
print("stopped", flush=True)
os.tcsetpgrp(0, child)
os.kill(child, signal.SIGCONT)
sys.exit(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
"""
"""Does what a shell does after ``cbtui &`` and ``fg``."""


@contextmanager
def recording_console(home: Path) -> Iterator[TerminalConsole]:
    """A console that records; when it has ended nothing of it may be left, and the recording is whole."""
    with nothing_left(), opened(100, 30, home, "open", "split-groups") as console:
        console.until("What do you expect?")
        console.press(_ESCAPE)
        console.until("LIVE")
        console.press("R")
        console.until("Recording to")
        yield console
    (path,) = Path.cwd().glob("*.mcap")
    assert read(path).damage is None


@pytest.mark.slow
def test_a_console_whose_window_is_closed_ends_and_finishes_its_recording(tmp_path: Path) -> None:
    with recording_console(tmp_path) as console:
        console.close_window()
        assert console.ended() == HUNG_UP


@pytest.mark.slow
@pytest.mark.parametrize("words", [(), ("open", "split-groups")])
def test_a_console_without_job_control_finds_that_its_window_was_closed(
    words: tuple[str, ...], tmp_path: Path
) -> None:
    with nothing_left(), opened(100, 30, tmp_path, *words, has_job_control=False) as console:
        console.until("Split groups")
        console.close_window()
        assert console.ended() == HUNG_UP


@pytest.mark.slow
def test_a_console_that_is_told_to_hang_up_gives_the_terminal_back(tmp_path: Path) -> None:
    with recording_console(tmp_path) as console:
        console.process.send_signal(signal.SIGHUP)
        assert console.ended() == HUNG_UP
        assert console.left_on() == set()
        assert "Recorded" in console.said()


@pytest.mark.slow
def test_a_console_that_is_told_to_go_on_while_it_ends_ends_all_the_same(tmp_path: Path) -> None:
    # A terminal multiplexer that closes a window hangs up, and then the kernel, which sends SIGCONT, too.
    with nothing_left(), opened(80, 24, tmp_path) as console:
        console.until("Split groups")
        console.process.send_signal(signal.SIGHUP)
        console.until(_LEFT)
        console.process.send_signal(signal.SIGCONT)
        assert console.ended() == HUNG_UP
        assert console.left_on() == set()


@pytest.mark.slow
def test_a_console_that_was_stopped_goes_on_and_gives_the_terminal_back(tmp_path: Path) -> None:
    with nothing_left(), opened(80, 24, tmp_path) as console:
        console.until("Split groups")
        console.process.send_signal(signal.SIGSTOP)
        os.waitpid(console.process.pid, os.WUNTRACED)
        console.process.send_signal(signal.SIGCONT)
        console.until(_TAKEN)
        console.until("Split groups")
        console.press("q")
        assert console.ended() == 0
        assert console.left_on() == set()


@pytest.mark.slow
def test_a_console_that_is_started_in_the_background_opens_once_it_is_in_the_foreground(
    tmp_path: Path,
) -> None:
    with nothing_left(), opened(80, 24, tmp_path, program=("-c", _SHELL)) as console:
        console.until("stopped")
        console.until("Split groups")
        console.press("q")
        assert console.ended() == 0, console.said()
        assert console.left_on() == set()


@pytest.mark.slow
def test_a_lesson_that_goes_on_after_a_stop_is_drawn_whole(tmp_path: Path) -> None:
    with nothing_left(), opened(80, 24, tmp_path, "open", "split-groups") as console:
        console.until("What do you expect?")
        console.press(_ESCAPE)
        console.until("LIVE")
        console.press("2")
        console.until("[2 Code]")
        console.process.send_signal(signal.SIGSTOP)
        os.waitpid(console.process.pid, os.WUNTRACED)
        console.process.send_signal(signal.SIGCONT)
        console.until(_TAKEN)
        console.until("[2 Code]")
        console.process.send_signal(signal.SIGHUP)
        assert console.ended() == HUNG_UP
