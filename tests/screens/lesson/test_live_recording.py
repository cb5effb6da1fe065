"""``R`` on a lesson: a recording of the run on screen, from the key until the key or the run's end."""

import errno
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from itertools import count
from pathlib import Path
from threading import Event

import pytest
from mcap.writer import Writer
from textual.app import App
from textual.pilot import Pilot

from cbtui.app import CbtuiApp
from cbtui.runs.live import live_recording
from cbtui.runs.live.live_recording import unused_name
from cbtui.runs.live.live_run import LiveRun
from sim.engine.commands import KeepContents
from sim.recording import BackgroundRecorder, Recording, read
from sim.trace.timeline import Timeline
from tests.support.builder import ns
from tests.support.console import WIDE, RecordedConsole, settle
from tests.support.exercises import until
from tests.support.pictures import lines_of, text_of
from tests.support.runs import shared_group_run


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The current folder."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@asynccontextmanager
async def console() -> AsyncIterator[tuple[RecordedConsole, Pilot[None]]]:
    """A console on a lesson, 5 s into its run."""
    app = RecordedConsole("shared-group", shared_group_run().events, 5.0)
    async with app.run_test(size=WIDE, notifications=True) as pilot:
        await settle(pilot)
        yield app, pilot


async def press(pilot: Pilot[None], *keys: str) -> None:
    await pilot.press(*keys)
    await settle(pilot)


def messages(app: RecordedConsole) -> list[str]:
    """What has been said in passing, each whole."""
    return [notification.message for notification in app._notifications]


def recorded(folder: Path) -> Recording:
    """The only recording in a folder."""
    (path,) = folder.iterdir()
    assert path.name.startswith("shared-group-")
    assert path.suffix == ".mcap"
    return read(path)


def timeline_of(recording: Recording) -> Timeline:
    timeline = Timeline()
    for events in recording.batches():
        timeline.extend(events)
    return timeline


@pytest.mark.slow
async def test_a_stretch_is_recorded_with_all_that_was_there_when_it_began(folder: Path) -> None:
    async with console() as (app, pilot):
        await press(pilot, "R")
        assert "REC " in lines_of(app)[0]
        assert "Recording to shared-group-" in text_of(app)
        app.engines.latest.play(ns(12.0))
        await settle(pilot)
        live = app.lesson_screen.runs.run.timeline
        now = live.moment(live.end)
        threads = [thread.name for thread in live.threads.values()]
        await press(pilot, "R")
        assert "REC " not in lines_of(app)[0]
        assert app.engines.latest.commands == [KeepContents(wanted=True), KeepContents(wanted=False)]
        app.engines.latest.play(ns(15.0))
        await settle(pilot)
    replayed = timeline_of(recorded(folder))
    assert replayed.end == live.moment(ns(12.0)).at == now.at
    assert [thread.name for thread in replayed.threads.values()] == threads
    assert replayed.moment(replayed.end).waiting == now.waiting


class SlowDisk:
    """Holds the end of every recording back until ``go_on`` is set."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.go_on = Event()
        close = BackgroundRecorder.close

        def held_back(recorder: BackgroundRecorder) -> None:
            assert self.go_on.wait(60), "nobody but the test waits for the disk"
            close(recorder)

        monkeypatch.setattr(BackgroundRecorder, "close", held_back)


@pytest.mark.slow
async def test_the_console_goes_on_while_the_end_of_a_recording_is_written(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with console() as (app, pilot):
        await press(pilot, "R")
        disk = SlowDisk(monkeypatch)
        await press(pilot, "R", "2")
        assert "REC " not in lines_of(app)[0]
        assert not any(text.startswith("Recorded ") for text in messages(app))
        disk.go_on.set()
        while not any(text.startswith("Recorded ") for text in messages(app)):
            await pilot.pause()
        assert recorded(folder).damage is None


@pytest.mark.slow
async def test_it_goes_on_at_the_end_of_the_run_too(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    async with console() as (app, pilot):
        await press(pilot, "R")
        disk = SlowDisk(monkeypatch)
        app.engines.latest.end("the engine was killed")
        await press(pilot, "2")
        assert "✗ LOST" in lines_of(app)[0]
        assert not any(text.startswith("Recorded ") for text in messages(app))
        disk.go_on.set()
        while not any(text.startswith("Recorded ") for text in messages(app)):
            await pilot.pause()
        assert recorded(folder).damage is None


@pytest.mark.slow
async def test_quitting_meanwhile_still_finishes_the_file(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with console() as (app, pilot):
        await press(pilot, "R")
        disk = SlowDisk(monkeypatch)
        await press(pilot, "R")
        stop = LiveRun.stop

        def stop_when_left(run: LiveRun) -> str | None:
            disk.go_on.set()
            return stop(run)

        monkeypatch.setattr(LiveRun, "stop", stop_when_left)
        await press(pilot, "ctrl+q")
    assert recorded(folder).damage is None
    assert app.saved[0].startswith("Recorded ")


@pytest.mark.slow
async def test_leaving_ends_the_recording_cleanly(folder: Path) -> None:
    async with console() as (app, pilot):
        await press(pilot, "R", "q")
        while not app.saved:
            await pilot.pause()
        (path,) = folder.iterdir()
        count = sum(map(len, recorded(folder).batches()))
        assert app.saved == [f"Recorded {count:,} events in {path.name}"]
        await until(pilot, lambda: app.saved[0] in messages(app))
    assert recorded(folder).damage is None


@pytest.mark.slow
async def test_quitting_the_console_ends_the_recording_cleanly(folder: Path) -> None:
    async with console() as (app, pilot):
        await press(pilot, "R", "ctrl+q")
    assert recorded(folder).damage is None
    assert app.saved[0].startswith("Recorded ")


def test_what_was_saved_is_said_once_more_when_the_console_is_gone(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    app = CbtuiApp()
    monkeypatch.setattr(App, "run", lambda _: app.saved.append("Recorded 41,204 events in run.mcap"))
    app.run()
    assert capsys.readouterr().err == "Recorded 41,204 events in run.mcap\n"


@pytest.mark.slow
async def test_the_end_of_the_run_ends_the_recording_and_says_so(folder: Path) -> None:
    async with console() as (app, pilot):
        await press(pilot, "R")
        app.engines.latest.end("the engine was killed")
        await settle(pilot)
        assert "REC " not in lines_of(app)[0]
        while not any(text.startswith("Recorded ") for text in messages(app)):
            await pilot.pause()
        assert recorded(folder).damage is None
        await press(pilot, "R")
        assert "REC " not in lines_of(app)[0]


@pytest.mark.slow
async def test_another_run_is_not_recorded(folder: Path) -> None:
    async with console() as (app, pilot):
        await press(pilot, "R", "t", "2")
        assert len(app.engines.sessions) == 2
        await until(pilot, lambda: any(text.startswith("Recorded ") for text in messages(app)))
        assert "REC " not in lines_of(app)[0]
        assert recorded(folder).damage is None


@pytest.mark.slow
async def test_what_cannot_be_recorded_is_said_in_a_sentence(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(live_recording, "unused_name", lambda _: folder / "missing" / "run.mcap")
    async with console() as (app, pilot):
        await press(pilot, "R")
        assert "cannot record to" in text_of(app)
        assert "REC " not in lines_of(app)[0]
        assert app.engines.latest.commands == []


@pytest.mark.slow
async def test_a_disk_that_fills_up_ends_the_recording_and_not_the_run(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fill_up(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    async with console() as (app, pilot):
        await press(pilot, "R")
        monkeypatch.setattr(Writer, "add_message", fill_up)
        for seconds in count(6):
            app.engines.latest.play(ns(seconds))
            await settle(pilot)
            if len(app.engines.latest.commands) > 1:
                break
        assert app.engines.latest.commands == [KeepContents(wanted=True), KeepContents(wanted=False)]
        (path,) = folder.iterdir()
        assert f"The recording {path.name} is not whole: No space left on device" in messages(app)
        assert "REC " not in lines_of(app)[0]
        assert "LIVE" in lines_of(app)[0]


def test_no_file_is_ever_replaced(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("time.strftime", lambda _: "20260102-030405")
    first = unused_name("a lesson/of mine")
    first.write_text("precious")
    assert first.name == "a-lesson-of-mine-20260102-030405.mcap"
    assert unused_name("a lesson/of mine").name == "a-lesson-of-mine-20260102-030405-2.mcap"
    assert unused_name("…").name == "run-20260102-030405.mcap"
    assert unused_name("x" * 500).name == f"{'x' * 60}-20260102-030405.mcap"
