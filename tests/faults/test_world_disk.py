"""Disks that are full, and two consoles that write to the same folder."""

import resource
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from threading import Barrier

import pytest

from cbtui.live_recording import LiveRecording
from cbtui.live_run import State
from sim.engine.setup import RunSetup
from sim.trace.recording import read
from tests.faults.support import ANSWERED, PATIENCE, console_on, node_with, nothing_left, still_here
from tests.support.runs import shared_group_run

LONG = "self.get_logger().info('x' * 2000 + str(time.monotonic()))"
ROOM = 20_000
"""Bytes that a file may have."""
CONSOLES = 8


@contextmanager
def files_of_at_most(size: int) -> Iterator[None]:
    """Let no file grow beyond a size, as if the disk were full; what is written beyond fails.

    Python compiles nothing meanwhile: versions before 3.13 keep what they could only write the beginning of.
    """
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys, "dont_write_bytecode", True)
        patch.setenv("PYTHONDONTWRITEBYTECODE", "1")
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
        try:
            yield
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, before)


def events_in(path: Path) -> int:
    return sum(map(len, read(path).batches()))


async def test_a_disk_that_fills_up_ends_the_recording_and_the_run_goes_on(folder: Path) -> None:
    async with console_on(node_with(folder, LONG, again=True)) as console:
        await console.until(still_here)
        with files_of_at_most(ROOM):
            await console.pilot.press("R")
            await console.until(lambda live: live.recorded is not None)
            await console.until(lambda live: live.recorded is None)
            assert await console.answers() < ANSWERED
        assert console.screen.live_run.state is State.LIVE
        said = [notification.message for notification in console.app._notifications]
        (path,) = folder.glob("*.mcap")
        assert f"The recording {path.name} is not whole: File too large" in said
    assert events_in(path) > 0


@pytest.mark.parametrize(
    ("option", "file", "what"),
    [("--record", "run.mcap", "the recording is"), ("--events", "run.jsonl", "the events in the file are")],
)
def test_a_disk_that_fills_up_does_not_end_a_run_without_a_console(
    folder: Path, option: str, file: str, what: str
) -> None:
    node_with(folder, LONG, again=True)
    words = ["run", "node.py", "--no-robot", "--clock", "virtual", "--for", "20", option, file]
    with nothing_left(), files_of_at_most(ROOM):
        ended = subprocess.run(
            [sys.executable, "-m", "cbtui", *words],
            check=False,
            capture_output=True,
            text=True,
            timeout=3 * PATIENCE,
        )
    assert ended.returncode == 1
    assert ended.stderr.splitlines()[-1] == f"cbtui: {what} not whole: File too large"
    assert "tick" in ended.stdout
    assert (folder / file).stat().st_size > ROOM / 2
    assert file == "run.jsonl" or events_in(folder / file) > 0


def test_consoles_that_record_the_same_lesson_at_once_get_a_file_each(folder: Path) -> None:
    together = Barrier(CONSOLES)
    events = shared_group_run().events

    def record(_number: int) -> str | None:
        recording = LiveRecording(RunSetup(title="shared-group", programs=()))
        together.wait(PATIENCE)
        recording.begin("R")
        recording.take(events)
        return recording.end()

    with ThreadPoolExecutor(CONSOLES) as pool:
        said = set(pool.map(record, range(CONSOLES)))
    paths = sorted(folder.glob("shared-group-*.mcap"))
    assert said == {f"Recorded {len(events):,} events in {path.name}" for path in paths}
    assert len(paths) == CONSOLES
    assert {events_in(path) for path in paths} == {len(events)}
