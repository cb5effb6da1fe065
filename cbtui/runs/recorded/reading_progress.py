"""Shows the progress of reading a recording on a terminal."""

import time
from collections.abc import Iterator

from cbtui.terminal.progress_line import ProgressLine
from sim.recording import Recording
from sim.trace.events import AnyEvent

_QUIET_TIME = 1.0
"""Seconds before progress is shown."""
_PERIOD = 0.2


class ReadingProgress:
    """The batches of a recording; progress goes to standard error if that is a terminal."""

    def __init__(self, recording: Recording) -> None:
        self._recording = recording

    def batches(self) -> Iterator[list[AnyEvent]]:
        """The events, in batches. Raises what the recording raises."""
        due = time.monotonic() + _QUIET_TIME
        with ProgressLine() as line:
            for events in self._recording.batches():
                if time.monotonic() > due:
                    due = time.monotonic() + _PERIOD
                    line.show(f"reading {self._recording.path.name}: {self._recording.share:.0%}")
                yield events
