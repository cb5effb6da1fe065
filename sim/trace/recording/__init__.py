"""Recordings: a run's events and messages in one ``.mcap`` file, written while it goes on and read later."""

from sim.trace.recording.about import About
from sim.trace.recording.background import BackgroundRecorder
from sim.trace.recording.beginning import Beginning
from sim.trace.recording.recorder import Recorder
from sim.trace.recording.recording import RecordedMessage, Recording, RecordingError, Topic, read

__all__ = [
    "About",
    "BackgroundRecorder",
    "Beginning",
    "RecordedMessage",
    "Recorder",
    "Recording",
    "RecordingError",
    "Topic",
    "read",
]
