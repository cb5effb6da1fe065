"""A disk that fills up at any byte: what was written before it gives its events back."""

import errno
import json
import os
from io import BytesIO
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest

from cbtui.runs.recorded.events_file import EventsFile
from sim.recording import RecordingError, RecordingMetadata, RecordingWriter, read, recorder
from sim.trace.events import AnyEvent, Notice, Severity
from tests.recording.files import run_in_batches, without_contents

BATCHES = run_in_batches(9)[:3]
EVENTS = [event for events in BATCHES for event in without_contents(events)]
FULL = os.strerror(errno.ENOSPC)
MANY = 1_000_000


class Disk(BytesIO):
    """The one file of a disk with so much room, and the path to it. Writes are cut short where it is full."""

    def __init__(self, room: int, content: bytes = b"") -> None:
        super().__init__(content)
        self.room = room
        self.seek(0, os.SEEK_END)

    def open(self, mode: str, buffering: int = -1) -> Any:
        return BytesIO(self.getvalue()) if mode == "rb" else self

    def exists(self) -> bool:
        return True

    def stat(self) -> SimpleNamespace:
        return SimpleNamespace(st_mode=0o100644)

    def write(self, data: Any) -> int:
        left = self.room - self.tell()
        if left <= 0:
            raise OSError(errno.ENOSPC, FULL)
        return super().write(data[:left])

    def truncate(self, size: int | None = None) -> int:
        super().truncate(size)
        return self.seek(0, os.SEEK_END)

    def close(self) -> None:
        """Keep the content."""

    @property
    def path(self) -> Path:
        return cast("Path", self)


@pytest.fixture(autouse=True)
def small_chunks(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(recorder, "_FIRST_CHUNK", 200)
    monkeypatch.setattr(recorder, "_CHUNK", 600)


def recorded(room: int, batches: list[list[AnyEvent]]) -> tuple[Disk, str | None]:
    """What a recording leaves on a disk with so much room, and why it failed."""
    disk = Disk(room)
    recording = RecordingWriter(disk.path, RecordingMetadata(title="small disk"))
    for events in batches:
        recording.take(events)
    recording.close()
    return disk, recording.failure


def events_on(disk: Disk) -> list[AnyEvent]:
    try:
        return [event for events in read(disk.path).batches() for event in events]
    except RecordingError:
        return []


@pytest.mark.parametrize("step", [19, pytest.param(1, marks=pytest.mark.bulk)])
def test_a_recording_gives_back_its_events_at_whichever_byte_its_disk_was_full(step: int) -> None:
    whole, failure = recorded(MANY, BATCHES)
    size = len(whole.getvalue())
    assert (failure, events_on(whole)) == (None, EVENTS)
    counts = {b"": 0}
    seen = []
    for room in range((size - 1) % step, size, step):
        disk, failure = recorded(room, BATCHES)
        content = disk.getvalue()
        assert failure == FULL
        assert whole.getvalue().startswith(content)
        assert len(content) <= room
        if content not in counts:
            events = events_on(disk)
            assert events == EVENTS[: len(events)]
            counts[content] = len(events)
        seen.append(counts[content])
    assert seen == sorted(seen)
    assert len(set(seen)) > 2
    assert seen[-1] == len(EVENTS)
    assert seen[len(seen) // 2] > 0


def test_a_long_program_takes_no_room_from_the_first_events_however_late_they_come(tmp_path: Path) -> None:
    program = tmp_path / "node.py"
    program.write_text("# a long program\n" * 1000)
    disk = Disk(2000)
    recording = RecordingWriter(disk.path, RecordingMetadata(programs=(str(program),)))
    recording.flush()
    recording.take(BATCHES[0])
    recording.close()
    assert recording.failure == FULL
    assert events_on(disk) == without_contents(BATCHES[0])


@pytest.mark.parametrize("step", [19, pytest.param(1, marks=pytest.mark.bulk)])
def test_a_recording_that_breaks_off_at_any_byte_gives_back_what_came_before(step: int) -> None:
    whole = recorded(MANY, BATCHES)[0].getvalue()
    seen = []
    for cut in range((len(whole) - 1) % step, len(whole), step):
        events = events_on(Disk(cut, whole[:cut]))
        assert events == EVENTS[: len(events)]
        seen.append(len(events))
    assert seen == sorted(seen)
    assert seen[-1] == len(EVENTS)


def test_a_large_batch_is_not_lost_as_a_whole() -> None:
    batch: list[AnyEvent] = [Notice(number, Severity.INFO, os.urandom(20).hex()) for number in range(500)]
    size = len(recorded(MANY, [batch])[0].getvalue())
    assert len(events_on(recorded(size // 2, [batch])[0])) > 200


def test_long_programs_come_after_the_first_events(tmp_path: Path) -> None:
    program = tmp_path / "long.py"
    program.write_text(f"# {os.urandom(50_000).hex()}")
    disk = Disk(20_000)
    recording = RecordingWriter(disk.path, RecordingMetadata(title="long", programs=(str(program),)))
    recording.take(EVENTS)
    recording.close()
    assert recording.failure == FULL
    assert events_on(disk)


def test_an_events_file_holds_whole_lines_at_whichever_byte_its_disk_was_full() -> None:
    def written(room: int) -> tuple[bytes, str | None]:
        disk = Disk(room, b"what was there\n")
        file = EventsFile(disk.path)
        file.begin()
        for events in BATCHES[:2]:
            file.take(events)
        file.close()
        return disk.getvalue(), file.failure

    whole, failure = written(MANY)
    assert failure is None
    assert len(whole.splitlines()) == sum(map(len, BATCHES[:2]))
    for room in range(15, len(whole)):
        content, failure = written(room)
        assert failure == FULL
        assert content == whole[: whole.rfind(b"\n", 0, room) + 1]
        for line in content.splitlines():
            json.loads(line)
