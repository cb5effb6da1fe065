"""The report of a failed test beside the reason: the lanes of its run as text, and a recording."""

import os
import re
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from cbtui.runs.headless.program_log import ProgramLog
from cbtui.runs.recorded.recording_file import CannotRecordError, start_recording
from sim.clock.schedule import Seed
from sim.engine.setup import RunSetup
from sim.quantities.nanoseconds import SECOND
from sim.trace.events import AnyEvent, Logged, Printed
from sim.trace.model import Nanoseconds, Window
from sim.trace.timeline import Timeline

_WIDTH = 100
_MOST_LANES = 24
_AROUND: Nanoseconds = 5 * SECOND
"""Time before and after its moment for which a failure shows the lanes."""
_MOST_LINES = 200


class Recordings:
    """The recordings of one test's runs; the folder is made with the first."""

    def __init__(self, folder: Path, test: str) -> None:
        self._folder = folder
        self._name = re.sub(r"[^\w.-]+", "-", test.replace(".py::", "-")).strip("-")[:150]

    def keep(self, setup: RunSetup, seed: Seed, events: Sequence[AnyEvent]) -> str:
        """Write a run to a file; returns a clause with its path and the command that opens it."""
        order = f"-seed{seed}" if seed else ""
        path = self._folder / f"{self._name}{re.sub('[:,=]+', '-', order)}.mcap"
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            recorder = start_recording(path, setup, replace=True)
        except (CannotRecordError, OSError) as error:
            return f"recording: {error}"
        recorder.take(events)
        recorder.close()
        shown = os.path.relpath(path)
        if recorder.failure is not None:
            return f"recording: {shown} is not whole: {recorder.failure}"
        return f"recording: cbtui replay {shown}"


def print_log(events: Sequence[AnyEvent], at: Nanoseconds | None) -> None:
    """Print the last lines of the log before a moment, None for the run's end, for pytest to capture."""
    before = [each for each in events if at is None or each.t <= at]
    written = [each for each in before if isinstance(each, Logged | Printed)]
    left_out = set(map(id, written[:-_MOST_LINES]))
    log = ProgramLog()
    log.print([each for each in before if id(each) not in left_out])
    log.finish()


def lanes_text(timeline: Timeline, at: Nanoseconds | None) -> Iterator[str]:
    """Yield the rows of the lanes around a moment, None for the run's end."""
    from cbtui.looks.theme import Charset
    from cbtui.widgets.lanes import LanePainter, wanted_rows

    now = timeline.end if at is None else at
    end = min(timeline.end, max(now + _AROUND, 2 * _AROUND))
    window = Window(max(0, min(now - _AROUND, end - 2 * _AROUND)), max(end, 1))
    charset = (
        Charset.BLOCK if (sys.__stdout__ and "utf" in sys.__stdout__.encoding.lower()) else Charset.ASCII
    )
    height = min(wanted_rows(timeline), _MOST_LANES)
    picture = LanePainter(charset).paint(timeline, window, now, _WIDTH, height)
    for row in picture.rows:
        yield "".join(run.text for run in row).rstrip()
