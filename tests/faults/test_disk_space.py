"""Disks that fill up while a run goes on: said once, before it is too late, and the run goes on."""

import errno
import os
import shutil
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from cbtui.runs.live.disk_space import DiskSpaceWatch
from cbtui.runs.live.live_run import LiveRun
from sim.engine.setup import RunSetup
from sim.trace import run_stores
from sim.trace.storage import spill_file
from sim.trace.timeline import Timeline
from tests.support.runs import shared_group_run

EVENTS = shared_group_run().events
RECORDING = Path("run.mcap")
GB = 1_000_000_000


def disk_with(monkeypatch: pytest.MonkeyPatch, free: int, total: int = 100 * GB) -> None:
    monkeypatch.setattr(shutil, "disk_usage", lambda _: SimpleNamespace(free=free, total=total))


@pytest.fixture
def full_temporary_folder(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let old blocks go to a temporary folder without room, and as soon as there are a few entries."""

    def refuse(**_: Any) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(spill_file, "TemporaryFile", refuse)
    monkeypatch.setattr(run_stores, "SpillFile", lambda: spill_file.SpillFile(entries=2))


@pytest.mark.usefixtures("full_temporary_folder")
def test_a_full_temporary_folder_is_said_at_once_in_a_live_run_which_goes_on() -> None:
    live = LiveRun(RunSetup(title="x", programs=()), lambda *_: SimpleNamespace(), print, print)
    said = [live.take(EVENTS[start : start + 20]) for start in range(0, len(EVENTS), 20)]
    (sentence,) = filter(None, said)
    assert said.index(sentence) < 5
    assert sentence.startswith("The folder for temporary files, ")
    assert "takes no more (No space left on device)" in sentence
    known = Timeline()
    known.extend(EVENTS)
    assert live.timeline.end == known.end


def test_a_large_recording_is_told_of_again_when_it_has_doubled(monkeypatch: pytest.MonkeyPatch) -> None:
    disk_with(monkeypatch, 50 * GB)
    watch = DiskSpaceWatch(Timeline())
    said = [watch.news(RECORDING, size * GB // 2) for size in range(1, 10)]
    assert [number for number, sentence in enumerate(said, start=1) if sentence] == [2, 4, 8]
    assert said[1] == "The recording run.mcap has 1,000 MB by now, and goes on"


def test_a_disk_is_said_to_fill_up_before_it_is_full(monkeypatch: pytest.MonkeyPatch) -> None:
    watch = DiskSpaceWatch(Timeline())
    disk_with(monkeypatch, 50 * GB)
    assert watch.news(RECORDING, 0) is None
    disk_with(monkeypatch, GB // 10)
    said = [watch.news(RECORDING, size * 1_000_000) for size in range(30)]
    (sentence,) = filter(None, said)
    assert said.index(sentence) == 10
    assert sentence.startswith("The disk has 100 MB left for the recording run.mcap, ")
    assert watch.news(Path("next.mcap"), 0) is not None


def test_a_small_disk_with_room_is_nothing_to_speak_of(monkeypatch: pytest.MonkeyPatch) -> None:
    disk_with(monkeypatch, GB // 10, GB // 5)
    assert DiskSpaceWatch(Timeline()).news(RECORDING, 0) is None
    assert DiskSpaceWatch(Timeline()).news(None, 0) is None
