"""Shows the progress of reading a recording."""

import time
from collections.abc import Iterator

from cbtui.terminal.progress_line import ProgressLine
from sim.recording import Recording
from sim.trace.events import AnyEvent

_QUIET_TIME = 1.0
"""Seconds before progress is shown."""
_PERIOD = 0.2
"""Seconds between two updates."""


def batches_with_progress(recording: Recording) -> Iterator[list[AnyEvent]]:
    """Yield the events of a recording in batches, and show the progress.

    Raises what the recording raises.
    """
    due = time.monotonic() + _QUIET_TIME
    with ProgressLine() as line:
        for events in recording.batches():
            if time.monotonic() > due:
                due = time.monotonic() + _PERIOD
                line.show(f"reading {recording.path.name}: {recording.share:.0%}")
            yield events
