"""Disks that are full, and two consoles that write to the same folder."""

import json
import os
import resource
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from threading import Barrier

import pytest

from cbtui.runs.live.live_recording import LiveRecording
from cbtui.runs.live.live_run import RunState
from sim.engine.setup import RunSetup
from sim.recording import read
from tests.faults.support import PATIENCE, console_on, node_with, nothing_left, still_here
from tests.support.daily import first_row_daily
from tests.support.runs import shared_group_run

LONG = "self.get_logger().info(os.urandom(1000).hex())"
"""Logs what no compression makes small: two seconds of it are more than there is room for."""
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


def run_node(seconds: int, option: str, file: Path | str) -> "subprocess.CompletedProcess[str]":
    """Run the folder's node without a console, written to a file; what it said when it has ended."""
    words = ["run", "node.py", "--no-robot", "--clock", "virtual", "--for", str(seconds), option, str(file)]
    command = [sys.executable, "-m", "cbtui", *words]
    return subprocess.run(command, check=False, capture_output=True, text=True)


def events_in(path: Path) -> int:
    return sum(map(len, read(path).batches()))


def told_in(path: Path) -> int:
    """How many events a recording or an events file gives back."""
    if path.suffix == ".mcap":
        return events_in(path)
    return len([json.loads(line) for line in path.read_text().splitlines()])


@pytest.mark.slow
async def test_a_disk_that_fills_up_ends_the_recording_and_the_run_goes_on(folder: Path) -> None:
    async with console_on(node_with(folder, LONG, again=True)) as console:

        def said() -> list[str]:
            return [notification.message for notification in console.app._notifications]

        await console.until(still_here)
        with files_of_at_most(ROOM):
            await console.pilot.press("R")
            await console.until(lambda _: any("not whole" in text for text in said()))
            assert console.screen.runs.run.recording.count is None
            await console.answers()
        assert console.screen.runs.run.state is RunState.LIVE
        (path,) = folder.glob("*.mcap")
        assert f"The recording {path.name} is not whole: File too large" in said()
    assert events_in(path) > 0


@pytest.mark.slow
@pytest.mark.parametrize(
    ("option", "file", "what"),
    first_row_daily(
        ("--record", "run.mcap", "the recording is"), ("--events", "run.jsonl", "the events in the file are")
    ),
)
def test_a_disk_that_fills_up_does_not_end_a_run_without_a_console(
    folder: Path, option: str, file: str, what: str
) -> None:
    node_with(folder, LONG, again=True)
    with nothing_left(), files_of_at_most(ROOM):
        ended = run_node(20, option, file)
    assert ended.returncode == 1
    assert ended.stderr.splitlines()[-1] == f"cbtui: {what} not whole: File too large"
    assert "tick" in ended.stdout
    assert (folder / file).stat().st_size > ROOM / 2
    assert told_in(folder / file) > 0


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """A file system of its own with room for 64 kB."""
    place = tmp_path / "disk"
    place.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=64k", "cbtui-test", str(place)]
    if os.geteuid() != 0 or subprocess.run(mount, check=False, capture_output=True).returncode:
        pytest.skip("file systems cannot be mounted here")
    yield place
    subprocess.run(["umount", "-l", str(place)], check=True)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("file", "taken"),
    first_row_daily(("run.mcap", 0), ("run.mcap", 50_000), ("run.jsonl", 0), ("run.jsonl", 50_000)),
)
def test_a_small_disk_that_fills_up_keeps_what_fits(
    folder: Path, small_disk: Path, file: str, taken: int
) -> None:
    node_with(folder, LONG, again=True)
    (small_disk / "other").write_bytes(bytes(taken))
    path = small_disk / file
    ended = run_node(2, "--record" if file == "run.mcap" else "--events", path)
    assert ended.returncode == 1
    assert ended.stderr.splitlines()[-1].endswith("not whole: No space left on device")
    assert told_in(path) > 0


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
