"""``x``: the run on screen as a file for other programs, made while the run goes on."""

import asyncio
import csv
import errno
import json
import xml.etree.ElementTree as ElementTree
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager
from pathlib import Path
from threading import Event
from typing import NoReturn

import perfetto.protos.perfetto.trace.perfetto_trace_pb2 as pb
import pytest
from textual.pilot import Pilot

from cbtui.app import CbtuiApp
from cbtui.keys.keymap import Keymap
from cbtui.runs.live.live_export import ExportableRun, LiveExport
from cbtui.runs.live.live_run import LiveRun
from cbtui.screens.parts import exporting
from cbtui.screens.replay import ReplayScreen
from cbtui.screens.windows.export import CHOICES, ExportScreen
from sim.export.csv import CallTable
from sim.recording import RecordingMetadata, read
from sim.trace.events import AnyEvent
from sim.trace.storage.event_store import EventStore
from tests.recording.files import write
from tests.support.builder import ns
from tests.support.console import NARROW, WIDE, RecordedConsole, settle
from tests.support.daily import first_daily
from tests.support.pictures import lines_of, text_of
from tests.support.runs import shared_group_run

EVENTS = shared_group_run().events


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The current folder."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@asynccontextmanager
async def console(
    size: tuple[int, int] = WIDE, keys: Keymap | None = None
) -> AsyncIterator[tuple[RecordedConsole, Pilot[None]]]:
    """A console on a lesson, 5 s into its run."""
    app = RecordedConsole("shared-group", EVENTS, 5.0, keys=keys)
    async with app.run_test(size=size, notifications=True) as pilot:
        await settle(pilot)
        yield app, pilot


async def press(pilot: Pilot[None], *keys: str) -> None:
    await pilot.press(*keys)
    await settle(pilot)


def messages(app: CbtuiApp) -> list[str]:
    """What has been said in passing, each whole."""
    return [notification.message for notification in app._notifications]


async def said(app: CbtuiApp, beginning: str) -> str:
    """What is said, as soon as it is, that begins so."""
    while True:
        for message in messages(app):
            if message.startswith(beginning):
                return message
        await asyncio.sleep(0.005)


async def exported(app: CbtuiApp, pilot: Pilot[None], key: str) -> Path:
    """The file that a choice of the window makes."""
    await press(pilot, "x", key)
    sentence = await said(app, "Exported to ")
    return Path(sentence.removeprefix("Exported to "))


@pytest.mark.parametrize("size", first_daily(WIDE, NARROW))
async def test_the_window_offers_every_format(size: tuple[int, int]) -> None:
    async with console(size) as (app, pilot):
        await press(pilot, "x")
        assert isinstance(app.screen, ExportScreen)
        picture = text_of(app)
        assert all(choice.meaning in picture for choice in CHOICES.values())
        await press(pilot, "escape")
        assert messages(app) == []


@pytest.mark.slow
async def test_its_key_and_those_of_the_window_can_be_chosen(folder: Path) -> None:
    keys = Keymap({"lesson.export": ("X",), "export.choose_table": ("j",)})
    async with console(keys=keys) as (app, pilot):
        await press(pilot, "X")
        assert "j  table" in text_of(app)
        await press(pilot, "j")
        await said(app, "Exported to ")
    assert [path.suffix for path in folder.iterdir()] == [".csv"]


@pytest.mark.slow
async def test_a_trace_of_a_live_run_has_its_beginning(folder: Path) -> None:
    async with console() as (app, pilot):
        path = await exported(app, pilot, "u")
        assert path.parent == folder
        assert path.name.startswith("shared-group-")
        assert path.suffix == ".pftrace"
    trace = pb.Trace()
    trace.ParseFromString(path.read_bytes())
    slices = [packet for packet in trace.packet if packet.HasField("track_event")]
    begun = min(packet.timestamp for packet in slices)
    assert begun < ns(1.0)
    assert max(packet.timestamp for packet in slices) <= begun + ns(5.0)


@pytest.mark.slow
async def test_a_table_tells_what_came_after_the_window_opened(folder: Path) -> None:
    async with console() as (app, pilot):
        await press(pilot, "x")
        app.engines.latest.play(ns(16.0))
        await settle(pilot)
        await press(pilot, "t")
        path = Path((await said(app, "Exported to ")).removeprefix("Exported to "))
    with path.open(newline="") as file:
        starts = [float(row["start_s"]) for row in csv.DictReader(file)]
    assert 5.0 < max(starts) <= 16.0


@pytest.mark.slow
async def test_the_other_formats_are_written_too() -> None:
    async with console() as (app, pilot):
        report = await exported(app, pilot, "r")
        assert report.read_text().startswith("# shared-group")
    async with console() as (app, pilot):
        trace = await exported(app, pilot, "c")
        assert json.loads(trace.read_text())["traceEvents"]


@pytest.mark.slow
async def test_a_picture_shows_the_stretch_on_screen_or_the_whole_run() -> None:
    async with console() as (app, pilot):
        await press(pilot, *["greater_than_sign"] * 3)
        window = app.lesson_screen.navigation.window
        assert window.start > 0
        picture = await exported(app, pilot, "p")
        ElementTree.parse(picture)
        assert f": {window.start / 1e9:g} to {window.end / 1e9:g} s" in picture.read_text()
    async with console() as (app, pilot):
        assert ": 0 to " in (await exported(app, pilot, "w")).read_text()


@pytest.mark.slow
async def test_no_file_is_ever_replaced(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("time.strftime", lambda _: "20260102-030405")
    taken = folder / "shared-group-20260102-030405.csv"
    taken.write_text("precious")
    async with console() as (app, pilot):
        path = await exported(app, pilot, "t")
    assert path.name == "shared-group-20260102-030405-2.csv"
    assert taken.read_text() == "precious"


def test_a_file_that_comes_in_between_is_left_alone(folder: Path) -> None:
    store = EventStore()
    store.take(EVENTS)
    export = LiveExport(ExportableRun("run", store.batches, EVENTS[-1].t), "csv", None)
    taken = export._path
    taken.write_text("precious")
    assert export.write() == f"Nothing was exported: cannot write {taken}: File exists"
    assert taken.read_text() == "precious"


def test_a_folder_that_takes_no_file_is_told_of(folder: Path) -> None:
    store = EventStore()
    store.take(EVENTS)
    export = LiveExport(ExportableRun("run", store.batches, EVENTS[-1].t), "svg", None)
    folder.rmdir()
    assert export.write() == f"Nothing was exported: cannot write {export._path}: No such file or directory"


@pytest.mark.slow
async def test_a_full_disk_is_told_of_and_leaves_no_file(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fill_up(*_: object) -> NoReturn:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(CallTable, "take", fill_up)
    async with console() as (app, pilot):
        await press(pilot, "x", "t")
        sentence = await said(app, "Nothing was exported")
        assert sentence.endswith("No space left on device")
        assert "● LIVE" in lines_of(app)[0]
    assert list(folder.iterdir()) == []


def test_what_a_tape_does_not_hold_is_said_with_the_file() -> None:
    store = EventStore()
    store.take(EVENTS)
    export = LiveExport(
        ExportableRun("run", store.batches, EVENTS[-1].t, "what came later is missing"), "csv", None
    )
    assert export.write() == f"Exported to {export._path}; what came later is missing"


class SlowDisk:
    """Holds an export back, after its first batch, until ``go_on`` is set."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.go_on = Event()
        self.held = Event()
        batches = EventStore.batches

        def held_back(store: EventStore) -> Iterator[list[AnyEvent]]:
            events = [event for batch in batches(store) for event in batch]
            yield events[:-10]
            self.held.set()
            assert self.go_on.wait(60), "nobody but the test waits for the disk"
            yield events[-10:]

        monkeypatch.setattr(EventStore, "batches", held_back)

    async def comes(self, pilot: Pilot[None]) -> None:
        """Wait until the export is held back."""
        while not self.held.is_set():
            await pilot.pause()


@pytest.mark.slow
async def test_the_keys_go_on_and_the_top_line_tells_how_far_it_is(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(exporting, "_PROGRESS_AFTER", 0.0)
    disk = SlowDisk(monkeypatch)
    async with console() as (app, pilot):
        await press(pilot, "x", "t")
        await disk.comes(pilot)
        await press(pilot, "2")
        assert "EXPORT 9" in lines_of(app)[0]
        assert len(list(folder.iterdir())) == 1
        await press(pilot, "x")
        assert messages(app)[-1].startswith("An export is being written, 9")
        disk.go_on.set()
        await said(app, "Exported to ")
        await settle(pilot)
        assert "EXPORT" not in lines_of(app)[0]


@pytest.mark.slow
async def test_an_export_that_is_soon_over_is_finished_when_the_lesson_is_left(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    disk = SlowDisk(monkeypatch)
    stop = LiveRun.stop

    def stop_when_left(run: LiveRun) -> str | None:
        disk.go_on.set()
        return stop(run)

    monkeypatch.setattr(LiveRun, "stop", stop_when_left)
    async with console() as (app, pilot):
        await press(pilot, "x", "t")
        await disk.comes(pilot)
        await press(pilot, "ctrl+q")
    (path,) = folder.iterdir()
    assert app.saved == [f"Exported to {path}"]


@pytest.mark.slow
async def test_one_that_is_not_is_given_up_and_leaves_no_file(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(exporting, "_EXIT_TIMEOUT", 0.0)
    disk = SlowDisk(monkeypatch)
    give_up = LiveExport.give_up

    def give_up_and_go_on(export: LiveExport) -> None:
        give_up(export)
        disk.go_on.set()

    monkeypatch.setattr(LiveExport, "give_up", give_up_and_go_on)
    async with console() as (app, pilot):
        await press(pilot, "x", "t")
        await disk.comes(pilot)
        await press(pilot, "ctrl+q")
    assert list(folder.iterdir()) == []
    (sentence,) = app.saved
    assert sentence.startswith("The export was cancelled, so shared-group-")


@pytest.mark.slow
async def test_a_recording_is_exported_whole(folder: Path) -> None:
    source = folder / "run.mcap"
    write(source, EVENTS, RecordingMetadata(title="shared-group", clock="virtual"))
    app = CbtuiApp(start_recording=read(source))
    app.animation_level = "none"
    async with app.run_test(size=WIDE, notifications=True) as pilot:
        await settle(pilot)
        assert isinstance(app.screen, ReplayScreen)
        while not app.screen.runs.run.is_read:
            await pilot.pause()
        path = await exported(app, pilot, "t")
        with path.open(newline="") as file:
            starts = [float(row["start_s"]) for row in csv.DictReader(file)]
        assert max(starts) > 20
        source.unlink()
        await press(pilot, "x", "t")
        assert "cannot be read" in await said(app, "Nothing was exported")
