"""A recording in the console: every pane alive, scrubbed both ways, played, never commanded."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import pytest
from textual.pilot import Pilot

from cbtui.app import CbtuiApp
from cbtui.runs.live.replay import RecordingReader, of_recording
from cbtui.runs.recorded.recording_file import about
from cbtui.screens.replay import ReplayScreen
from cbtui.widgets.shell import Prompt
from lessons.catalogue import lessons
from sim.engine.setup import ProgramSetup, RunSetup
from sim.recording import Recording, RecordingMetadata, RunSnapshot, read
from sim.trace.events import AnyEvent, KeyboardAsked, Reading, RunEnded
from tests.recording.files import timeline_of, write, write_in_chunks
from tests.support.builder import ns
from tests.support.console import WIDE, settle
from tests.support.daily import first_slow
from tests.support.exercises import until
from tests.support.pictures import lines_of, text_of
from tests.support.runs import shared_group_run

PROGRAM = "/no/such/place/shared.py"


def recording(folder: Path, told: RecordingMetadata | None = None) -> Recording:
    """A recording of a lesson's run that lasts about 20 s."""
    path = folder / "run.mcap"
    write(path, shared_group_run().events, told or RecordingMetadata(title="shared-group", clock="virtual"))
    return read(path)


@asynccontextmanager
async def replayed(shown: Recording) -> AsyncIterator[tuple[ReplayScreen, Pilot[None]]]:
    """The console on a recording that has been read to its end."""
    app = CbtuiApp(start_recording=shown)
    app.animation_level = "none"
    async with app.run_test(size=WIDE, notifications=True) as pilot:
        await settle(pilot)
        screen = app.screen
        assert isinstance(screen, ReplayScreen)
        while not screen.runs.run.is_read:
            await asyncio.sleep(0.01)
        screen.draw()
        await settle(pilot)
        yield screen, pilot


def begun_late(folder: Path) -> Recording:
    """A recording that was begun 12 s after its run."""
    snapshot, events = RunSnapshot(), shared_group_run().events
    before = [event for event in events if event.t <= ns(12)]
    snapshot.take(before)
    late = [*snapshot.events(), *events[len(before) :]]
    write(folder / "late.mcap", late, RecordingMetadata(title="shared-group", clock="virtual"))
    return read(folder / "late.mcap")


async def test_a_recording_begun_late_is_shown_and_played_from_where_it_was_begun(tmp_path: Path) -> None:
    async with replayed(begun_late(tmp_path)) as (screen, pilot):
        begun = screen.runs.timeline.begun
        assert begun > ns(11.5)
        await press(pilot, "space")
        assert screen.navigation.now >= screen.navigation.window.start >= begun
        await press(pilot, "space")
        screen.navigation.seek(0)
        await press(pilot, "left", "[", "comma")
        assert screen.navigation.now == screen.navigation.window.start == begun


def status(pilot: Pilot[None]) -> str:
    return lines_of(pilot.app)[0]


async def press(pilot: Pilot[None], *keys: str) -> None:
    await pilot.press(*keys)
    assert isinstance(pilot.app.screen, ReplayScreen)
    pilot.app.screen.draw()
    await settle(pilot)


async def test_nobody_is_told_to_type_for_a_program_that_is_over(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    asked = KeyboardAsked(ns(1.0), Reading.LINES, "teleop.py")
    write(path, [*shared_group_run().until(0.5), asked], RecordingMetadata(title="teleop", clock="virtual"))
    async with replayed(read(path)) as (_, pilot):
        assert "teleop.py waits for input from the keyboard" in text_of(pilot.app)
        assert "type it" not in text_of(pilot.app)


async def test_a_recording_opens_at_its_end_with_every_pane_alive(tmp_path: Path) -> None:
    events = shared_group_run().events
    async with replayed(recording(tmp_path)) as (screen, pilot):
        assert screen.runs.run.timeline.end == timeline_of([events]).end
        assert "‖ REPLAY" in status(pilot)
        assert f"t {screen.runs.run.timeline.end / 1e9:.3f} s" in status(pilot)
        picture = text_of(pilot.app)
        assert "Recording of shared-group" in picture
        assert "␣ go on" in picture
        assert "MainThread" in picture
        assert "[sub_node]" in picture


async def test_at_its_end_it_tells_how_the_run_ended(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    events = shared_group_run().events
    write(path, [*events, RunEnded(events[-1].t, "its time was up", failed=False)])
    async with replayed(read(path)) as (_, pilot):
        assert "the run is over: its time was up; space plays it from its beginning" in text_of(pilot.app)
        await press(pilot, "comma")
        assert "the run is over" not in text_of(pilot.app)


@pytest.mark.slow
async def test_it_can_be_scrubbed_both_ways(tmp_path: Path) -> None:
    async with replayed(recording(tmp_path)) as (screen, pilot):
        timeline = screen.runs.run.timeline
        before = timeline.neighbour(timeline.end, -1)
        assert before is not None
        await press(pilot, "comma")
        assert f"t {before / 1e9:.3f} s" in status(pilot)
        await press(pilot, "left_square_bracket")
        assert f"t {before / 1e9 - 1:.3f} s" in status(pilot)
        await press(pilot, "right_square_bracket", "full_stop")
        assert f"t {timeline.end / 1e9:.3f} s" in status(pilot)


@pytest.mark.slow
async def test_the_way_back_from_the_past_leads_to_its_end_not_to_a_present(tmp_path: Path) -> None:
    async with replayed(recording(tmp_path)) as (_, pilot):
        await press(pilot, "left_square_bracket")
        keys = lines_of(pilot.app)[-1]
        assert "0 end" in keys
        assert "0 live" not in keys


@pytest.mark.slow
async def test_it_plays_at_the_chosen_speed_from_its_beginning_and_stands_at_its_end(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    wall = [0]
    monkeypatch.setattr("cbtui.screens.replay.monotonic_ns", lambda: wall[0])
    async with replayed(recording(tmp_path)) as (screen, pilot):
        run = screen.runs.run
        await press(pilot, "plus", "space")
        assert "▶ REPLAY  virtual ×2.0   t 0.000 s" in status(pilot)
        wall[0] += ns(1.5)
        screen.play()
        screen.draw()
        await settle(pilot)
        assert "t 3.000 s" in status(pilot)
        await press(pilot, "space")
        assert "‖ REPLAY" in status(pilot)
        await press(pilot, "space")
        wall[0] += run.timeline.end
        screen.play()
        screen.draw()
        await settle(pilot)
        assert f"t {run.timeline.end / 1e9:.3f} s" in status(pilot)
        assert "‖ REPLAY" in status(pilot)


async def test_a_key_that_needs_a_run_says_why_it_does_nothing(tmp_path: Path) -> None:
    async with replayed(recording(tmp_path)) as (_, pilot):
        for key, sentence in (
            ("s", "This is a recording: nothing in it can be called, changed, recorded or run again."),
            ("r", "This is a recording: "),
            ("R", "This is a recording: "),
            ("t", "This is a recording: "),
            ("n", "No lesson follows here: q leads to the menu"),
            ("C", "There is only one run so far"),
            ("a", "Only lessons are explained; d lists what went wrong here."),
        ):
            pilot.app.clear_notifications()
            await press(pilot, key)
            assert any(note.message.startswith(sentence) for note in pilot.app._notifications), key


@pytest.mark.slow
async def test_nothing_that_needs_an_engine_is_offered_or_done(tmp_path: Path) -> None:
    async with replayed(recording(tmp_path)) as (screen, pilot):
        for action in ("call_service", "prompt", "reset_world", "run_again", "threads", "record", "step"):
            assert screen.check_action(action, ()) is False
        before = status(pilot)
        await press(pilot, "s", "S", "t", "r", "R", "colon", "full_stop")
        assert status(pilot) == before
        assert not screen.query_one(Prompt).display
        assert list(tmp_path.iterdir()) == [tmp_path / "run.mcap"]


@pytest.mark.slow
async def test_what_cannot_be_read_is_said_in_one_sentence_and_the_rest_is_shown(tmp_path: Path) -> None:
    whole = tmp_path / "whole.mcap"
    events = shared_group_run().events
    write_in_chunks(whole, [events[start : start + 40] for start in range(0, len(events), 40)])
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(whole.read_bytes()[: whole.stat().st_size // 2])
    async with replayed(read(cut)) as (screen, pilot):
        assert 0 < screen.runs.run.timeline.end < timeline_of([events]).end
        assert screen.runs.run.damage is not None
        assert "breaks off at byte" in screen.runs.run.damage
        await until(pilot, lambda: "breaks off at byte" in text_of(pilot.app))
        assert "‖ REPLAY" in status(pilot)


@pytest.mark.parametrize("place", [*first_slow(50, 5, 35, 65, 80), *first_slow(20, 95)])
async def test_a_damaged_recording_never_ends_the_console(place: int, tmp_path: Path) -> None:
    path = recording(tmp_path).path
    content = bytearray(path.read_bytes())
    at = len(content) * place // 100
    content[at : at + 20] = bytes(byte ^ 0xFF for byte in content[at : at + 20])
    path.write_bytes(content)
    async with replayed(read(path)) as (_, pilot):
        await press(pilot, "left_square_bracket", "comma", "0")
        assert "REPLAY" in status(pilot)


def test_the_code_is_that_which_was_recorded_although_the_file_has_changed(tmp_path: Path) -> None:
    program = tmp_path / "node.py"
    program.write_text("print('as it was')\n")
    setup = RunSetup(title="node.py", programs=(ProgramSetup(str(program)),), clock="real")
    shown = recording(tmp_path, about(setup))
    program.write_text("print('as it is')\n")
    assert of_recording(shown).source == "print('as it was')\n"
    assert of_recording(shown).set_up(None, 1.0) == setup


def test_a_program_that_neither_was_recorded_nor_is_here_is_said_to_be_missing(tmp_path: Path) -> None:
    subject = of_recording(recording(tmp_path, RecordingMetadata(title="away", programs=(PROGRAM,))))
    assert subject.node_path == Path(PROGRAM)
    assert subject.source is not None
    assert "holds no source" in subject.source


def test_a_recording_of_a_lesson_with_a_scene_shows_that_scene(tmp_path: Path) -> None:
    lesson = next(each for each in lessons() if each.scene)
    subject = of_recording(recording(tmp_path, RecordingMetadata(title=lesson.id, clock="virtual")))
    assert subject.scene == lesson.scene


def test_recorded_texts_are_shown_as_texts(tmp_path: Path) -> None:
    told = RecordingMetadata(title="[x](y)\x1b[31m", programs=("/a\0b",), recorded=10**30 % 2**63)
    subject = of_recording(recording(tmp_path, told))
    assert "\x1b" not in subject.heading + subject.guide
    assert r"\[x\]\(y\)" in subject.guide
    assert str(subject.node_path) == "/ab"


def test_a_recording_that_goes_away_while_it_is_read_ends_with_a_sentence(tmp_path: Path) -> None:
    shown = recording(tmp_path)
    shown.path.unlink()
    ended: list[str | None] = []
    delivered: list[list[AnyEvent]] = []
    session = RecordingReader(shown, delivered.append, ended.append)
    session.start()
    session.stop()
    assert ended == [f"{shown.path} cannot be read to its end: No such file or directory"]
    assert delivered == []
