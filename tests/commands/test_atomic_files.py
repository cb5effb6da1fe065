"""What is written to a file is there whole, or the file is as it was; whatever comes in between."""

import errno
import os
import stat
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from cbtui.runs.recorded.events_file import EventsFile
from cbtui.runs.recorded.exporting import FORMATS, ExportError, ExportRequest, export
from sim.files.atomic import atomic_file, write_atomically
from sim.trace.events import AnyEvent
from tests.support.runs import shared_group_run

EVENTS = shared_group_run().events


def full(_: object) -> None:
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def interrupted(_: object) -> None:
    raise KeyboardInterrupt


class Broken:
    """Events of which the second batch cannot be had."""

    def __init__(self, error: BaseException) -> None:
        self.error = error

    def batches(self) -> Iterator[list[AnyEvent]]:
        yield EVENTS[:50]
        raise self.error


class Whole:
    def batches(self) -> Iterator[list[AnyEvent]]:
        yield EVENTS


@pytest.mark.parametrize("there", [True, False])
@pytest.mark.parametrize("error", [KeyboardInterrupt(), OSError(errno.EIO, "Input/output error")])
@pytest.mark.parametrize("form", FORMATS)
def test_an_export_that_fails_leaves_the_folder_as_it_was(
    tmp_path: Path, form: str, error: BaseException, there: bool
) -> None:
    target = tmp_path / "out"
    if there:
        target.write_text("before")
    with pytest.raises((ExportError, KeyboardInterrupt)):
        export(Broken(error).batches, ExportRequest({form: target}))
    assert [path.read_text() for path in tmp_path.iterdir()] == ["before"] * there


@pytest.mark.parametrize("fails", [full, interrupted])
def test_a_full_disk_or_ctrl_c_at_the_last_moment_leaves_the_folder_as_it_was(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, fails: Callable[[object], None]
) -> None:
    target = tmp_path / "out.csv"
    target.write_text("before")
    monkeypatch.setattr(os, "fsync", fails)
    with pytest.raises((ExportError, KeyboardInterrupt)):
        export(Whole().batches, ExportRequest({"csv": target}))
    assert [path.read_text() for path in tmp_path.iterdir()] == ["before"]


def test_permissions_and_links_are_kept(tmp_path: Path) -> None:
    target, link = tmp_path / "target", tmp_path / "link"
    target.write_text("before")
    target.chmod(0o640)
    link.symlink_to("target")
    write_atomically(link, b"after")
    assert link.is_symlink()
    assert (target.read_bytes(), stat.S_IMODE(target.stat().st_mode)) == (b"after", 0o640)
    write_atomically(link, b"itself", follow=False)
    assert (link.is_symlink(), target.read_bytes(), link.read_bytes()) == (False, b"after", b"itself")


def test_a_new_file_has_usual_permissions(tmp_path: Path) -> None:
    write_atomically(tmp_path / "ours", b"")
    (tmp_path / "plain").touch()
    assert (tmp_path / "ours").stat().st_mode == (tmp_path / "plain").stat().st_mode


def test_the_file_is_as_before_until_all_is_written(tmp_path: Path) -> None:
    target = tmp_path / "out"
    target.write_text("before")
    with atomic_file(target) as file:
        file.write(b"after")
        assert target.read_text() == "before"
    assert target.read_text() == "after"
    assert list(tmp_path.iterdir()) == [target]


def test_what_is_there_is_not_replaced_unless_it_may_be(tmp_path: Path) -> None:
    (tmp_path / "out").symlink_to("nowhere")
    with pytest.raises(FileExistsError):
        write_atomically(tmp_path / "out", b"after", replace=False)
    write_atomically(tmp_path / "new", b"new", replace=False)
    assert {path.name for path in tmp_path.iterdir()} == {"out", "new"}


def test_a_device_is_written_to_as_it_is(tmp_path: Path) -> None:
    write_atomically(Path(os.devnull), b"gone")
    assert stat.S_ISCHR(Path(os.devnull).stat().st_mode)


@pytest.mark.parametrize("there", [True, False])
def test_an_events_file_that_got_nothing_is_not_left_behind(tmp_path: Path, there: bool) -> None:
    target = tmp_path / "run.jsonl"
    if there:
        target.write_text("before")
    EventsFile(target).close()
    assert [path.read_text() for path in tmp_path.iterdir()] == ["before"] * there
