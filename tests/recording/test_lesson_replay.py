"""A lesson that was recorded is in a replay what it was live, at any time and for every pane."""

import random
from collections.abc import Callable
from pathlib import Path
from queue import Queue

import msgspec
import pytest

from cbtui.runs.live.replay import RecordingReader
from cbtui.runs.setup.lesson_setup import setup_for
from lessons.catalogue import find
from sim.engine.setup import TimedCall
from sim.recording import RecordingMetadata, RecordingWriter, read
from sim.trace.events import AnyEvent, MessageSent
from sim.trace.figures.statistics import statistics
from sim.trace.model import Window
from sim.trace.timeline import Timeline
from tests.recording.files import timeline_of
from tests.support.engine_runs import SECOND, Run, run_to_end

TIMES = 1000
LONGEST_WINDOW = SECOND // 2
FLUSHED_EVERY = 500
PATIENCE = 60.0


@pytest.fixture(scope="module")
def lesson() -> Run:
    """Eight seconds of the shared group: waits, drops, calls, logs, scans, and what messages hold."""
    setup = setup_for(find("shared-group"), speed=None)
    calls = tuple(TimedCall(at * SECOND, data=at < 5) for at in (1, 6))
    return run_to_end(msgspec.structs.replace(setup, until=8 * SECOND, calls=calls, contents=True))


@pytest.fixture(scope="module")
def recorded(lesson: Run, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("lesson") / "run.mcap"
    recorder = RecordingWriter(path, RecordingMetadata(title="shared-group", clock="virtual"))
    for start in range(0, len(lesson.events), FLUSHED_EVERY):
        recorder.take(lesson.events[start : start + FLUSHED_EVERY])
        recorder.flush()
    recorder.close()
    return path


def read_from_file(path: Path) -> Timeline:
    return timeline_of(read(path).batches())


def read_by_the_console(path: Path) -> Timeline:
    news: Queue[list[AnyEvent] | str | None] = Queue()
    session = RecordingReader(read(path), news.put, news.put)
    session.start()
    timeline = Timeline()
    try:
        while isinstance(batch := news.get(timeout=PATIENCE), list):
            timeline.extend(batch)
    finally:
        session.stop()
    assert batch is None
    return timeline


READINGS = (read_from_file, read_by_the_console)
every_reading = pytest.mark.parametrize("replayed", READINGS, ids=lambda reading: reading.__name__)


def state(timeline: Timeline, at: int) -> tuple[object, ...]:
    """What panes show of a moment."""
    return (
        timeline.moment(at),
        timeline.robot(at),
        timeline.scan(at),
        timeline.scan_seen(at),
        timeline.command(at),
        timeline.logs_until(at),
        timeline.dropped(at),
        [timeline.neighbour(at, step) for step in (1, -1)],
    )


def stretch(timeline: Timeline, window: Window) -> tuple[object, ...]:
    """What panes show of a window."""
    return (
        timeline.marks(window),
        timeline.trail(window),
        [(timeline.spans_on(each, window), timeline.blocks_on(each, window)) for each in timeline.threads],
        [(timeline.busy(each, window)) for each in timeline.threads],
        [(timeline.waits_of(each, window), timeline.drops_of(each, window)) for each in timeline.entities],
        [timeline.spans_in(each, window) for each in timeline.groups],
        statistics(timeline, window),
    )


def whole(timeline: Timeline) -> tuple[object, ...]:
    """What is asked of a run without a time."""
    return (
        (
            timeline.started,
            timeline.ended,
            timeline.end,
            timeline.arena,
            timeline.lost,
            timeline.contents_lost,
        ),
        (timeline.threads, timeline.executors, timeline.nodes, timeline.groups, timeline.entities),
        (timeline.calls, timeline.logs, timeline.shell, timeline.notices),
        statistics(timeline),
    )


@pytest.mark.slow
@every_reading
def test_a_replayed_lesson_is_what_it_was_at_a_thousand_times(
    lesson: Run, recorded: Path, replayed: Callable[[Path], Timeline]
) -> None:
    live, again = timeline_of([lesson.events]), replayed(recorded)
    chance = random.Random(len(lesson.events))
    for _ in range(TIMES):
        at = chance.randint(-1, live.end + 1)
        window = Window(at, at + chance.randint(0, LONGEST_WINDOW))
        assert state(again, at) == state(live, at)
        assert stretch(again, window) == stretch(live, window)


@every_reading
def test_a_replayed_lesson_is_what_it_was_as_a_whole(
    lesson: Run, recorded: Path, replayed: Callable[[Path], Timeline]
) -> None:
    assert whole(replayed(recorded)) == whole(timeline_of([lesson.events]))


def test_the_lesson_has_of_everything_that_could_be_lost(lesson: Run) -> None:
    live = timeline_of([lesson.events])
    always = Window(0, live.end + 1)
    middle = live.end * 3 // 4
    assert live.dropped(live.end) > 0
    assert max(len(queue.messages) for queue in live.moment(middle).queues.values()) == 10
    assert any(live.waits_of(entity, always) for entity in live.entities)
    assert live.scan_seen(middle) not in {None, live.scan(middle)}
    assert {mark.kind for mark in live.marks(always)} >= {"command", "call", "reply"}
    assert any(isinstance(event, MessageSent) for event in lesson.events)
