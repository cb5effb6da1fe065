"""Recording on a thread of its own: nobody waits, and what could not be kept is counted and told."""

import subprocess
import sys
import threading
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest

from sim.recording import BackgroundRecorder, RecordingMetadata, RecordingWriter, read
from sim.trace.events import (
    AnyEvent,
    MessageSent,
    Notice,
    RunStarted,
    Severity,
    ThreadAppeared,
    TimePassed,
    TopicAppeared,
)
from tests.recording.files import ABOUT, run_in_batches, without_contents

BATCHES = run_in_batches()


def kept(path: Path) -> list[AnyEvent]:
    return [event for events in read(path).batches() for event in events]


def test_everything_is_written_when_it_is_closed(tmp_path: Path) -> None:
    recorder = BackgroundRecorder(RecordingWriter(tmp_path / "run.mcap", ABOUT))
    for events in BATCHES:
        recorder.take(events)
    recorder.close()
    recorder.close()
    every = [event for events in BATCHES for event in events]
    assert kept(tmp_path / "run.mcap") == without_contents(every)
    assert (recorder.lost, recorder.failure) == (0, None)


def test_what_was_counted_is_what_a_reader_counts_without_messages_and_topics(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    recorder = BackgroundRecorder(RecordingWriter(path, ABOUT))
    sent = [TopicAppeared(0, 1, "/odom", "nav_msgs/msg/Odometry", "", "", ""), MessageSent(1, 1, 1, b"x")]
    recorder.take([RunStarted(0, "run", "real", 0), *sent, *notices(3, 2), TimePassed(9), TimePassed(10)])
    recorder.close()
    assert recorder.count == len(kept(path)) == 5


class Slow(RecordingWriter):
    """A recorder on a disk that stands until it is told to go on."""

    def __init__(self, path: Path) -> None:
        super().__init__(path, RecordingMetadata(title="slow"))
        self.reached = threading.Event()
        self.disk_goes_on = threading.Event()

    def take(self, events: Iterable[AnyEvent]) -> None:
        self.reached.set()
        self.disk_goes_on.wait()
        super().take(events)


def notices(count: int, since: int = 0) -> list[AnyEvent]:
    return [Notice(number, Severity.INFO, str(number)) for number in range(since, since + count)]


def test_what_comes_while_too_much_waits_is_left_out_counted_and_told(tmp_path: Path) -> None:
    slow = Slow(tmp_path / "run.mcap")
    recorder = BackgroundRecorder(slow, room=1000)
    first = [RunStarted(0, "slow", "real", 0), *notices(9)]
    late = ThreadAppeared(20, 1, "worker")
    recorder.take(first)
    recorder.take([*notices(5, 10), late])
    recorder.take(notices(2, 20))
    assert (recorder.count, recorder.lost) == (0, 7)
    slow.disk_goes_on.set()
    while recorder.waiting:
        slow.reached.wait(0.001)
    recorder.take(notices(1, 30))
    recorder.close()
    told = Notice(30, Severity.WARN, "7 events before this came faster than they could be recorded")
    assert kept(tmp_path / "run.mcap") == [*first, late, told, *notices(1, 30)]
    assert recorder.count == 13


def test_a_disk_that_fails_is_told_and_nobody_waits(tmp_path: Path) -> None:
    recorder = BackgroundRecorder(RecordingWriter(Path("/dev/full"), ABOUT, replace=True))
    for events in BATCHES:
        recorder.take(events)
    recorder.close()
    assert recorder.failure == "No space left on device"


FORGETFUL = """
import sys
from pathlib import Path
from sim.trace.events import RunStarted
from sim.recording import RecordingMetadata, BackgroundRecorder, RecordingWriter
recorder = BackgroundRecorder(RecordingWriter(Path(sys.argv[1]), RecordingMetadata(title="forgotten")))
recorder.take([RunStarted(0, "forgotten", "real", 0)])
{ending}
"""


@pytest.mark.parametrize("ending", ["", "raise SystemExit(3)", "1 / 0"])
def test_an_interpreter_that_exits_ends_its_recordings(tmp_path: Path, ending: str) -> None:
    path = tmp_path / "run.mcap"
    program: Any = [sys.executable, "-c", FORGETFUL.format(ending=ending), str(path)]
    subprocess.run(program, check=False, capture_output=True)
    assert kept(path) == [RunStarted(0, "forgotten", "real", 0)]
    assert read(path).damage is None
