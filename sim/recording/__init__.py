"""Recordings: a run's events and messages in one ``.mcap`` file, written while it goes on and read later."""

from sim.recording.background import BackgroundRecorder
from sim.recording.metadata import RecordingMetadata
from sim.recording.recorder import RecordingWriter
from sim.recording.recording import RecordedMessage, Recording, RecordingError, Topic, read
from sim.recording.snapshot import RunSnapshot

__all__ = [
    "RecordingMetadata",
    "BackgroundRecorder",
    "RunSnapshot",
    "RecordedMessage",
    "RecordingWriter",
    "Recording",
    "RecordingError",
    "Topic",
    "read",
]
