"""Records a run on screen while the user wants it."""

import re
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TypeAlias

from cbtui.runs.recorded.recording_file import NameTakenError, start_recording
from sim.engine.setup import RunSetup
from sim.recording import BackgroundRecorder, RecordingWriter, RunSnapshot
from sim.trace.events import AnyEvent

FinishFile: TypeAlias = Callable[[], str]
"""Finishes a recording and returns a sentence on its content; may block, on any thread."""

_LONGEST_TITLE = 60
_MOST_NAMES = 1000
_NAME_RETRIES = 100
"""How often another console may take a name first."""


class LiveRecording:
    """Records any number of periods of a run, each to a file of its own.

    It follows the run all the time, since each file begins with a snapshot of the run. Files are written on
    threads of their own. Used on one thread; only ``end`` may be called from any.
    """

    def __init__(self, setup: RunSetup) -> None:
        self._setup = setup
        self._snapshot = RunSnapshot()
        self._recorder: BackgroundRecorder | None = None

    @property
    def count(self) -> int | None:
        """How many events have been recorded; None if nothing is being recorded."""
        return None if self._recorder is None else self._recorder.count

    @property
    def path(self) -> Path | None:
        """The file that is being written; None if there is none."""
        return None if self._recorder is None else self._recorder.path

    @property
    def size(self) -> int:
        """Bytes in that file; 0 if there is none."""
        return 0 if self._recorder is None else self._recorder.size

    @property
    def lost(self) -> int:
        """How many events came too fast to be recorded; 0 if nothing is being recorded."""
        return 0 if self._recorder is None else self._recorder.lost

    def begin(self, key: str) -> str:
        """Begin a recording in the current folder, and say so; ``key`` is what ends it.

        Raises:
            CannotRecordError: it cannot be made.
        """
        self._recorder = BackgroundRecorder(self._recorder_here(_NAME_RETRIES))
        self._recorder.take(self._snapshot.events())
        return f"Recording to {self._recorder.path}; press {key} again to stop"

    def _recorder_here(self, tries: int) -> RecordingWriter:
        try:
            return start_recording(unused_name(self._setup.title), self._setup)
        except NameTakenError:
            if not tries:
                raise
            return self._recorder_here(tries - 1)

    def take(self, events: list[AnyEvent]) -> str | None:
        """Process events; returns a sentence if the recording ended because it cannot be written."""
        self._snapshot.take(events)
        recorder = self._recorder
        if recorder is None:
            return None
        recorder.take(events)
        return None if recorder.failure is None else self.end()

    def end(self) -> str | None:
        """Finish the recording; returns a sentence on its content, None if there is none. Blocks."""
        finish = self.detach()
        return None if finish is None else finish()

    def detach(self) -> FinishFile | None:
        """Stop recording; returns the function that finishes the file, None if nothing is being recorded."""
        recorder, self._recorder = self._recorder, None
        return None if recorder is None else partial(_finish, recorder)


def _finish(recorder: BackgroundRecorder) -> str:
    recorder.close()
    if recorder.failure is not None:
        return f"The recording {recorder.path} is not whole: {recorder.failure}"
    lost = f"; {recorder.lost:,} came too fast and are missing in it" if recorder.lost else ""
    return f"Recorded {recorder.count:,} events in {recorder.path}{lost}"


def unused_name(title: str, suffix: str = ".mcap") -> Path:
    """Return a file name of title and time that is unused in the current folder."""
    plain = re.sub(r"[^A-Za-z0-9_-]+", "-", title).strip("-")[:_LONGEST_TITLE] or "run"
    stem = f"{plain}-{time.strftime('%Y%m%d-%H%M%S')}"
    names = (Path(f"{stem}{'' if number == 1 else f'-{number}'}{suffix}") for number in range(1, _MOST_NAMES))
    return next((name for name in names if not name.exists()), Path(f"{stem}{suffix}"))
