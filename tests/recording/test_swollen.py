"""Recordings that unpack to much more than they are: bounded, said in a sentence, read in little memory."""

import tracemalloc
from pathlib import Path
from typing import Any

import pytest
from mcap.writer import CompressionType, Writer

from cbtui.runs.recorded.reading_progress import batches_with_progress
from sim.recording import batch, chunk, read
from sim.recording.metadata import NAME, RecordingMetadata, to_metadata
from sim.trace.events import AnyEvent, Notice, RunStarted, Severity

START: list[AnyEvent] = [RunStarted(0, "x", "virtual", 0)]
NOTICES: list[AnyEvent] = [Notice(1, Severity.INFO, "")] * 1000
LITTLE = 60_000_000
"""Bytes of memory."""


def write(path: Path, chunks: list[list[bytes]], compression: CompressionType = CompressionType.ZSTD) -> None:
    """Write a recording of packed batches, each list a chunk of its own."""
    with path.open("wb") as file:
        writer: Any = Writer(file, chunk_size=10**12, compression=compression)
        writer.start(profile="ros2", library="cbtui 1")
        writer.add_metadata(NAME, to_metadata(RecordingMetadata(title="swollen", clock="virtual")))
        schema = writer.register_schema(batch.TYPE, "ros2msg", batch.DEFINITION.encode())
        writer.register_channel(batch.TOPIC, "cdr", schema)
        for packed in chunks:
            for each in packed:
                writer.add_message(1, 1, each, 1, 1)
            writer.flush()
        writer.finish()


def test_what_no_recording_of_the_size_can_hold_is_left_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(chunk, "_FEW", 1_000_000)
    path = tmp_path / "run.mcap"
    write(path, [[batch.pack_batch(START)], *[[batch.pack_batch(NOTICES)] * 20] * 100])
    most = chunk.unpacked_most(path.stat().st_size)
    assert path.stat().st_size < 65_000
    recording = read(path)
    tracemalloc.start()
    count = sum(len(events) for events in recording.batches())
    assert tracemalloc.get_traced_memory()[1] < LITTLE
    tracemalloc.stop()
    assert 100_000 < count < most / 15
    assert recording.damage == (
        f"it unpacks to more than {most // 1_000_000} MB, which no recording of its size does, "
        "and the rest is left out"
    )


def test_no_recording_that_is_compressed_as_ours_is_bounded(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(chunk, "_FEW", 0)
    path = tmp_path / "run.mcap"
    write(path, [[batch.pack_batch(START)], *[[batch.pack_batch(NOTICES)] * 10] * 10], CompressionType.LZ4)
    recording = read(path)
    assert sum(len(events) for events in recording.batches()) == 100_001
    assert recording.damage is None


def test_a_batch_that_is_larger_than_any_is_left_out(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    large = batch.pack_batch(NOTICES * (batch._MOST // len(batch.pack_batch(NOTICES)) + 10))
    assert batch._MOST < len(large) < 1.1 * batch._MOST
    write(path, [[batch.pack_batch(START)], [large], [batch.pack_batch(NOTICES)]])
    recording = read(path)
    tracemalloc.start()
    assert sum(len(events) for events in recording.batches()) == 1001
    assert tracemalloc.get_traced_memory()[1] < LITTLE
    tracemalloc.stop()
    assert "1 part of it is damaged" in str(recording.damage)


@pytest.mark.parametrize("terminal", [True, False])
def test_reading_for_more_than_a_second_shows_how_far_it_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], terminal: bool
) -> None:
    monkeypatch.setattr("sys.stderr.isatty", lambda: terminal)
    monkeypatch.setattr("cbtui.runs.recorded.reading_progress._QUIET_TIME", -1.0)
    monkeypatch.setattr("cbtui.runs.recorded.reading_progress._PERIOD", -1.0)
    path = tmp_path / "run.mcap"
    write(path, [[batch.pack_batch(NOTICES)]] * 4)
    list(batches_with_progress(read(path)))
    shown = capsys.readouterr().err
    assert ("reading run.mcap: 4" in shown) is terminal
    assert shown == "" or shown.endswith("\r\x1b[K")
