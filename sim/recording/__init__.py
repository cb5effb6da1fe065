"""Recordings: a run's events and messages in one ``.mcap`` file, written during the run and read later."""

from sim.recording.background import BackgroundRecorder
from sim.recording.metadata import RecordingMetadata
from sim.recording.recorder import RecordingWriter
from sim.recording.recording import Recording, RecordingError, Topic, read
from sim.recording.snapshot import RunSnapshot

__all__ = [
    "RecordingMetadata",
    "BackgroundRecorder",
    "RunSnapshot",
    "RecordingWriter",
    "Recording",
    "RecordingError",
    "Topic",
    "read",
]
