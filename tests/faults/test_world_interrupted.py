"""Ctrl-C at moments that a seed chooses among all there are, and the other ways in which a run is ended."""

import os
import random
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from lessons.catalogue import find
from sim.recording import RecordingMetadata, RecordingWriter, read
from tests.faults.support import PATIENCE, node_with, nothing_left
from tests.support.daily import first_daily, first_row_daily
from tests.support.processes import engines_of
from tests.support.runs import shared_group_run
from tests.terminal.console import opened

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="processes are looked up in /proc")

MOMENTS = int(os.environ.get("CBTUI_INTERRUPTIONS", "1"))
"""How many moments of each command are tried; a hundred take half an hour."""
LATEST = 120_000
"""Calls of functions among which the moments are; the commands make some 60,000 to 250,000."""
INTERRUPTED = 130
EXERCISE = "split-groups"
LOOPS_START = ["BaseSelectorEventLoop.__init__", "BaseSelectorEventLoop._make_self_pipe"]
LOOPS_END = ["_UnixSelectorEventLoop.remove_signal_handler", "BaseSelectorEventLoop._close_self_pipe"]
"""Functions of asyncio in which an exception leaves a loop that is neither open nor closed."""
SCRIPT = str(Path(__file__).with_name("interrupted.py"))
RUN = ("run", "node.py", "--no-robot", "--record", "run.mcap")
COMMANDS = {
    "run": (*RUN, "--clock", "virtual", "--for", "5"),
    "check": ("check", EXERCISE, "split_groups.py"),
    "grade": ("grade", "learners", "--lesson", EXERCISE, "--csv", "grades.csv"),
    "compare": ("compare", "node.py", "node.py", "--to", "2"),
    "export": ("export", "whole.mcap", "--svg", "a.svg", "--csv", "a.csv", "--perfetto", "a.pftrace"),
    "explore": ("explore", "node.py", "--schedules", "2", "--for", "1"),
}
MOMENTS_OF_COMMANDS = [
    (name, random.Random(f"{name} {seed}").randint(1, LATEST)) for name in COMMANDS for seed in range(MOMENTS)
]


EVENTS = shared_group_run().events


@pytest.fixture(autouse=True)
def files(folder: Path) -> None:
    """What the commands work on."""
    solution = find(EXERCISE).solution_path
    assert solution is not None
    shutil.copy(solution, "split_groups.py")
    Path("learners").mkdir()
    shutil.copy(solution, "learners/split_groups_ann.py")
    node_with(folder, "open('reached', 'w')")
    recorder = RecordingWriter(Path("whole.mcap"), RecordingMetadata(title="whole"))
    recorder.take(EVENTS)
    recorder.close()


class Command:
    """A command that goes on; what it said is there when it has ended."""

    def __init__(self, *words: str) -> None:
        self.process = subprocess.Popen(
            [sys.executable, *words],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            start_new_session=True,
            text=True,
        )
        self.said = self.complained = ""

    def until(self, condition: Callable[[], object]) -> None:
        """Wait until something is so."""
        deadline = time.monotonic() + PATIENCE
        while not condition():
            assert time.monotonic() < deadline
            assert self.process.poll() is None
            time.sleep(0.002)

    def engines(self) -> list[int]:
        """Its engines' processes, from their first moment on."""
        return engines_of(self.process.pid)

    def told(self, number: signal.Signals) -> int:
        """Send its group a signal, as a terminal does; its exit code."""
        os.killpg(self.process.pid, number)
        return self.ended()

    def ended(self) -> int:
        """Wait for its end; its exit code."""
        self.said, self.complained = self.process.communicate(timeout=PATIENCE)
        return self.process.returncode


def recording_is_whole() -> bool:
    recording = read(Path("run.mcap"))
    return recording.damage is None and sum(map(len, recording.batches())) > 0


@pytest.mark.parametrize(("name", "moment"), first_row_daily(*MOMENTS_OF_COMMANDS))
def test_ctrl_c_ends_a_command_at_any_moment_without_a_word(name: str, moment: int) -> None:
    with nothing_left():
        command = Command(SCRIPT, str(moment), *COMMANDS[name])
        code = command.ended()
    assert code == (INTERRUPTED if Path("interrupted").exists() else 0)
    assert "Traceback" not in command.complained
    assert "Exception" not in command.complained
    if Path("run.mcap").exists():
        assert read(Path("run.mcap")).damage is None


@pytest.mark.slow
@pytest.mark.parametrize("moment", [random.Random(seed).randint(1, LATEST // 2) for seed in range(MOMENTS)])
def test_ctrl_c_ends_a_server_at_any_moment_without_a_word(moment: int) -> None:
    with nothing_left():
        command = Command(SCRIPT, str(moment), "serve", "--port", "0")
        assert command.process.stdout is not None
        if command.process.stdout.readline():
            os.killpg(command.process.pid, signal.SIGINT)
        assert command.ended() in (0, INTERRUPTED)
    assert command.complained == ""


@pytest.mark.slow
@pytest.mark.parametrize("moment", [random.Random(seed).randint(1, LATEST) for seed in range(MOMENTS)])
def test_ctrl_c_ends_a_console_that_starts_and_gives_the_terminal_back(moment: int, tmp_path: Path) -> None:
    with (
        nothing_left(),
        opened(80, 24, tmp_path, "open", EXERCISE, program=[SCRIPT, str(moment)]) as console,
    ):
        assert console.ended() == INTERRUPTED
        assert console.left_on() == set()
        assert "Traceback" not in console.said()
        assert "Exception" not in console.said()
        assert "fault of its own" not in console.said()


@pytest.mark.slow
@pytest.mark.parametrize(
    "function", first_daily(*LOOPS_START, "EndingApp.run", "EndingApp.run_async", "ending_signals_on_loop")
)
def test_ctrl_c_before_the_console_hears_it_ends_it_before_it_draws(function: str, tmp_path: Path) -> None:
    with opened(80, 24, tmp_path, program=[SCRIPT, function]) as console:
        assert console.ended() == INTERRUPTED
        assert re.fullmatch(rb"(opening \.\.\.\r\x1b\[K)*", console.drawn), "it was taken away"
        assert console.left_on() == set()


@pytest.mark.slow
@pytest.mark.parametrize("function", ["MenuScreen.compose", "RunScreen.compose", "LogView.on_mount"])
def test_ctrl_c_while_the_console_puts_its_widgets_together_ends_it(function: str, tmp_path: Path) -> None:
    with opened(80, 24, tmp_path, "open", EXERCISE, "--exercise", program=[SCRIPT, function]) as console:
        assert console.ended() == INTERRUPTED
        assert console.left_on() == set()
        assert "fault of its own" not in console.said()


@pytest.mark.slow
@pytest.mark.parametrize("function", LOOPS_END)
def test_ctrl_c_as_a_console_that_was_left_ends_finds_all_of_it_whole(function: str, tmp_path: Path) -> None:
    with opened(80, 24, tmp_path, program=[SCRIPT, function]) as console:
        console.until("Unit 5")
        console.press("q")
        assert console.ended() == INTERRUPTED
        assert console.left_on() == set()
        assert "Traceback" not in console.said()
        assert "Exception" not in console.said()


@pytest.mark.slow
def test_ctrl_c_as_an_engine_starts_is_not_the_engines() -> None:
    with nothing_left():
        command = Command("-m", "cbtui", *RUN, "--clock", "real")
        command.until(command.engines)
        assert command.told(signal.SIGINT) == INTERRUPTED
    assert command.complained == ""
    assert recording_is_whole()


@pytest.mark.slow
@pytest.mark.parametrize("number", first_daily(signal.SIGINT, signal.SIGTERM, signal.SIGHUP))
def test_a_run_that_is_told_to_end_tells_and_records_what_it_came_to(number: signal.Signals) -> None:
    with nothing_left():
        command = Command("-m", "cbtui", *RUN, "--clock", "real")
        command.until(Path("reached").exists)
        assert command.told(number) == 128 + number
    assert "tick" in command.said
    assert "Traceback" not in command.complained
    assert recording_is_whole()


@pytest.mark.slow
def test_an_engine_that_is_stopped_keeps_nobody_from_ending_its_run() -> None:
    with nothing_left():
        command = Command("-m", "cbtui", *RUN, "--clock", "real")
        command.until(Path("reached").exists)
        (engine,) = command.engines()
        os.kill(engine, signal.SIGSTOP)
        assert command.told(signal.SIGINT) == INTERRUPTED
    assert recording_is_whole()
