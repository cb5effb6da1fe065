"""Recordings for tests: of a run with topics, in as many chunks as a test wants."""

from collections.abc import Iterable, Sequence
from pathlib import Path

from sim.recording import RecordingMetadata, RecordingWriter
from sim.trace.events import AnyEvent, MessageSent, TimePassed, TopicAppeared
from sim.trace.timeline import Timeline
from tests.support.runs import shared_group_run

ABOUT = RecordingMetadata(
    title="shared-group", clock="virtual", threads=2, programs=(__file__,), recorded=1_700_000_000
)
TOPICS: list[AnyEvent] = [
    TopicAppeared(0, 1, "/flag", "std_msgs/msg/Bool", "bool data\n"),
    TopicAppeared(0, 2, "/number", "std_msgs/msg/Int32", "int32 data\n"),
]


def message(t: int, number: int) -> MessageSent:
    """Every third message is a Bool, the others are Int32."""
    if number % 3 == 0:
        return MessageSent(t, number, 1, b"\x00\x01\x00\x00\x01")
    return MessageSent(t, number, 2, b"\x00\x01\x00\x00" + number.to_bytes(4, "little"))


def write(path: Path, events: Iterable[AnyEvent], about: RecordingMetadata = ABOUT) -> None:
    """Record a batch of events to a new file."""
    recorder = RecordingWriter(path, about)
    recorder.take(events)
    recorder.close()
    assert recorder.failure is None


def write_in_chunks(path: Path, batches: Iterable[Sequence[AnyEvent]]) -> None:
    """Record batches, each as a chunk of its own."""
    recorder = RecordingWriter(path, ABOUT)
    for events in batches:
        recorder.take(events)
        recorder.flush()
    recorder.close()
    assert recorder.failure is None


def run_in_batches(size: int = 40) -> list[list[AnyEvent]]:
    """A run with messages among its events."""
    events = shared_group_run().events
    mixed = [*TOPICS]
    for number, event in enumerate(events):
        mixed += [event, message(event.t, number)]
    return [mixed[start : start + size] for start in range(0, len(mixed), size)]


def without_contents(events: Iterable[AnyEvent]) -> list[AnyEvent]:
    """The events that a timeline looks at."""
    return [event for event in events if not isinstance(event, TopicAppeared | MessageSent | TimePassed)]


def timeline_of(batches: Iterable[Sequence[AnyEvent]]) -> Timeline:
    """The timeline of batches."""
    timeline = Timeline()
    for events in batches:
        timeline.extend(events)
    return timeline
