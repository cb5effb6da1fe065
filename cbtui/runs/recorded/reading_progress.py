"""Shows the progress of reading a recording on a terminal."""

import sys
import time
from collections.abc import Iterator

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
        shown = False
        try:
            for events in self._recording.batches():
                if time.monotonic() > due and sys.stderr.isatty():
                    due, shown = time.monotonic() + _PERIOD, True
                    _show(f"reading {self._recording.path.name}: {self._recording.share:.0%}")
                yield events
        finally:
            if shown:
                _show("")


def _show(text: str) -> None:
    sys.stderr.write(f"\r\x1b[K{text}")
    sys.stderr.flush()
