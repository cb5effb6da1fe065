"""Files that were cut, damaged, or are something else: what is readable is read, the rest is one sentence."""

import os
import random
import signal
import struct
import subprocess
import sys
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest
from mcap.writer import CompressionType, Writer

from sim.recording import Recording, RecordingError, RecordingMetadata, RecordingWriter, batch, read
from sim.trace.events import AnyEvent, ArenaShown, Printed, RunStarted, TopicAppeared
from sim.trace.figures.summary import summarise
from sim.trace.figures.summary_text import plain_text
from tests.recording.files import (
    run_in_batches,
    timeline_of,
    without_contents,
    write,
    write_in_chunks,
)
from tests.support.daily import first_daily, first_slow

BATCHES = run_in_batches(100)[:15]
CAST = [
    event
    for event in BATCHES[0]
    if isinstance(event, RunStarted | ArenaShown)
    or (type(event).__name__.endswith("Appeared") and not isinstance(event, TopicAppeared))
]
KEPT = [without_contents(events) for events in BATCHES]


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    path = tmp_path_factory.mktemp("recording") / "run.mcap"
    write_in_chunks(path, BATCHES)
    return path.read_bytes()


def opened(path: Path, content: bytes) -> Recording | str:
    """The recording in a file of that content, or why there is none."""
    path.write_bytes(content)
    try:
        return read(path)
    except RecordingError as error:
        (sentence,) = str(error).splitlines()
        return sentence


def batches_of(recording: Recording) -> list[list[AnyEvent]]:
    """The batches, once everything else can be told of them too."""
    batches = list(recording.batches())
    timeline = timeline_of(batches)
    assert plain_text(summarise(timeline))
    timeline.moment(timeline.end // 2)
    assert sum(topic.count for topic in recording.topics()) == len(list(recording.messages()))
    return batches


@pytest.mark.slow
def test_a_recording_that_was_cut_holds_what_came_before(whole: bytes, tmp_path: Path) -> None:
    chance = random.Random(1)
    held = []
    for cut in sorted(chance.randrange(len(whole)) for _ in range(200)):
        recording = opened(tmp_path / "cut.mcap", whole[:cut])
        if isinstance(recording, str):
            assert cut < 200, recording
            continue
        batches = batches_of(recording)
        assert batches == KEPT[: len(batches)]
        assert recording.damage is not None
        assert len(recording.damage.splitlines()) == 1
        held.append(len(batches))
    assert held == sorted(held)
    assert max(held) == len(KEPT)


@pytest.mark.parametrize("seed", first_slow(*range(4)))
def test_flipped_bytes_cost_no_more_than_the_chunks_they_are_in(
    whole: bytes, tmp_path: Path, seed: int
) -> None:
    chance = random.Random(seed)
    for _ in range(100):
        flips = chance.randint(1, 3)
        damaged = bytearray(whole)
        for _ in range(flips):
            damaged[chance.randrange(len(whole))] ^= chance.randint(1, 255)
        recording = opened(tmp_path / "flipped.mcap", bytes(damaged))
        assert isinstance(recording, Recording), recording
        batches = [events for events in batches_of(recording) if events != CAST]
        assert all(events in KEPT for events in batches)
        assert len(batches) >= len(KEPT) - 2 * flips
        assert recording.damage is not None or batches == KEPT


@pytest.mark.slow
def test_damaged_beginnings_and_lengths_are_read_over(whole: bytes, tmp_path: Path) -> None:
    for place in range(0, 300, 3):
        for value in (0, 1, 255):
            damaged = whole[:place] + bytes([value]) + whole[place + 1 :]
            recording = opened(tmp_path / "flipped.mcap", damaged)
            assert isinstance(recording, Recording), recording
            assert len(list(recording.batches())) >= len(KEPT) - 2


@pytest.mark.parametrize("beginning", [b"", b"\x89MCAP0\r\n"])
def test_noise_is_no_recording(tmp_path: Path, beginning: bytes) -> None:
    chance = random.Random(3)
    for length in (1, 7, 8, 9, 100, 5000):
        sentence = opened(tmp_path / "noise.mcap", beginning + chance.randbytes(length))
        assert isinstance(sentence, str)
        assert "is not a recording" in sentence


def test_an_empty_file_a_folder_and_none_are_told_apart(tmp_path: Path) -> None:
    assert str(opened(tmp_path / "empty.mcap", b"")).endswith("is empty")
    for path, reason in ((tmp_path, "Is a directory"), (tmp_path / "none", "No such file or directory")):
        with pytest.raises(RecordingError, match=f"cannot be read: {reason}"):
            read(path)


def test_a_foreign_mcap_file_is_told_to_be_one(tmp_path: Path) -> None:
    path = tmp_path / "foreign.mcap"
    with path.open("wb") as file:
        writer = Writer(file, compression=CompressionType.LZ4)
        writer.start("ros2", "somebody")
        schema = writer.register_schema("std_msgs/msg/Bool", "ros2msg", b"bool data\n")
        channel = writer.register_channel("/flag", "cdr", schema)
        writer.add_message(channel, 1, b"\0\1\0\0\1", 1)
        writer.finish()  # type: ignore[no-untyped-call]
    with pytest.raises(RecordingError, match="not a recording of cbtui: nothing is on /cbtui/events"):
        read(path)


def test_a_newer_format_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(batch, "FORMAT", 2)
    write(tmp_path / "run.mcap", BATCHES[0])
    monkeypatch.undo()
    with pytest.raises(RecordingError, match="is in format 2, and this cbtui knows formats up to 1"):
        read(tmp_path / "run.mcap")


def test_chunks_that_claim_nonsense_are_left_out_without_being_believed(whole: bytes, tmp_path: Path) -> None:
    first = whole.index(b"\x03\0\0\0lz4")
    for size in (2**63, 2**40, 200_000_000, 1):
        damaged = whole[: first - 12] + struct.pack("<Q", size) + whole[first - 4 :]
        recording = opened(tmp_path / "nonsense.mcap", damaged)
        assert isinstance(recording, Recording)
        assert list(recording.batches()) == [CAST, *KEPT[1:]]
        assert recording.damage is not None
        assert recording.damage.startswith("1 part of it is damaged")


WRITER = """
import sys, time
from pathlib import Path
from sim.trace.events import Printed, RunStarted
from sim.recording import RecordingMetadata, BackgroundRecorder, RecordingWriter
recorder = RecordingWriter(Path(sys.argv[1]), RecordingMetadata(title="killed"))
if sys.argv[2] == "background":
    recorder = BackgroundRecorder(recorder)
recorder.take([RunStarted(0, "killed", "real", 0)])
number = 0
while True:
    number += 1
    recorder.take([Printed(number, f"{number} {'x' * 100}", error=False)])
    if number % 500 == 0:
        print(number, flush=True)
    time.sleep(0.0002)
"""


@pytest.mark.parametrize("kind", first_daily("background", "direct"))
def test_a_recorder_that_is_killed_leaves_all_that_it_took_before_its_last_write(
    tmp_path: Path, kind: str
) -> None:
    chance = random.Random(5)
    for turn in range(2):
        path = tmp_path / f"{turn}.mcap"
        program = [sys.executable, "-c", WRITER, str(path), kind]
        process = subprocess.Popen(program, stdout=subprocess.PIPE)
        assert process.stdout is not None
        for _ in range(chance.randint(1, 4)):
            taken = int(process.stdout.readline())
        _until(partial(_has_printed, path, taken))
        os.kill(process.pid, signal.SIGKILL)
        process.communicate()
        recording = read(path)
        events = [event for events in recording.batches() for event in events]
        printed = [event for event in events if isinstance(event, Printed)]
        assert events[0] == RunStarted(0, "killed", "real", 0)
        assert [int(event.text.split()[0]) for event in printed] == list(range(1, len(printed) + 1))
        assert recording.damage is not None
        assert "breaks off" in recording.damage


def test_what_was_taken_lately_is_written_without_more_coming(tmp_path: Path) -> None:
    recorder = RecordingWriter(tmp_path / "run.mcap", RecordingMetadata(title="quiet"))
    recorder.take(BATCHES[0])
    _until(lambda: list(read(tmp_path / "run.mcap").batches()) == KEPT[:1])
    recorder.close()


def _has_printed(path: Path, lines: int) -> bool:
    events = (event for events in read(path).batches() for event in events)
    return sum(isinstance(event, Printed) for event in events) >= lines


def _until(condition: Callable[[], bool]) -> None:
    for _ in range(1000):
        if condition():
            return
        time.sleep(0.01)
    pytest.fail("it never came to that")
