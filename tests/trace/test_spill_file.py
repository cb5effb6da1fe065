"""What a timeline spills comes back as it was, wherever it had to be put."""

import errno
import gc
import tempfile
from io import FileIO
from pathlib import Path

import pytest

from sim.trace.storage import spill_file as module
from sim.trace.storage.spill_file import SpillFile


def unchanged(data: bytes) -> bytes:
    return data


def test_bytes_are_read_back_from_their_place() -> None:
    spill = SpillFile(cache_size=1)
    lengths = range(1, 9)
    places = [spill.append(bytes([length]) * length) for length in lengths]
    for place, length in reversed(list(zip(places, lengths, strict=True))):
        assert spill.read(place, length, unchanged) == bytes([length]) * length


def test_bytes_in_the_place_of_others_are_read_back() -> None:
    spill = SpillFile(cache_size=1)
    first, second = spill.append(b"abc"), spill.append(b"def")
    spill.replace(first, b"xyz")
    assert [spill.read(place, 3, unchanged) for place in (first, second)] == [b"xyz", b"def"]


def test_what_was_looked_up_last_is_decoded_once() -> None:
    spill = SpillFile(cache_size=2)
    decoded: list[bytes] = []

    def decode(data: bytes) -> bytes:
        decoded.append(data)
        return data

    a, b, c = (spill.append(data) for data in (b"a", b"b", b"c"))
    for place in (a, b, a, c, a, b):
        spill.read(place, 1, decode)
    assert decoded == [b"a", b"b", b"c", b"b"]


def test_no_file_is_made_before_there_is_something_to_spill(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "TemporaryFile", lambda **_: pytest.fail("made a file"))
    SpillFile()


def test_the_file_has_no_name_and_is_closed_with_its_owner(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    files: list[FileIO] = []

    def make(**options: object) -> object:
        files.append(tempfile.TemporaryFile(dir=tmp_path, buffering=0))  # noqa: SIM115
        return files[-1]

    monkeypatch.setattr(module, "TemporaryFile", make)
    spill = SpillFile()
    spill.append(b"abc")
    (file,) = files
    was_closed = [file.closed]
    del spill
    gc.collect()
    assert [*was_closed, file.closed] == [False, True]
    assert not list(tmp_path.iterdir())


def test_where_no_file_can_be_made_bytes_stay_in_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(**_: object) -> None:
        raise FileNotFoundError(errno.ENOENT, "No usable temporary directory found")

    monkeypatch.setattr(module, "TemporaryFile", refuse)
    spill = SpillFile(cache_size=1)
    first, second = spill.append(b"abc"), spill.append(b"def")
    spill.replace(second, b"xyz")
    assert [spill.read(place, 3, unchanged) for place in (first, second)] == [b"abc", b"xyz"]


class SmallDisk:
    """A file on a disk that has room for ten bytes."""

    def __init__(self) -> None:
        self.file = tempfile.TemporaryFile(buffering=0)  # noqa: SIM115
        self.seek, self.read, self.close = self.file.seek, self.file.read, self.file.close

    def write(self, data: bytes) -> int:
        room = max(0, 10 - self.file.tell())
        if not room:
            raise OSError(errno.ENOSPC, "No space left on device")
        return self.file.write(data[:room])


def test_what_a_full_disk_does_not_take_stays_in_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "TemporaryFile", lambda **_: SmallDisk())
    spill = SpillFile(cache_size=1)
    places = [spill.append(data) for data in (b"12345678", b"abcdefgh", b"ABCDEFGH")]
    spill.replace(places[0], b"87654321")
    assert [spill.read(place, 8, unchanged) for place in places] == [b"87654321", b"abcdefgh", b"ABCDEFGH"]
