"""Warns once about each disk that fills up while a run goes on."""

import shutil
import tempfile
from pathlib import Path

from sim.trace.timeline import Timeline

_LARGE_RECORDING = 1_000_000_000
"""Bytes of a recording from which on its size is reported, each time that it has doubled."""
_LOW_SPACE = 500_000_000
"""Free bytes that cause a warning; the smaller of this and the share below counts."""
_LOW_SHARE = 0.05
_CHECK_INTERVAL = 10_000_000
"""Bytes by which a recording grows between two checks of its disk."""


class DiskSpaceWatch:
    """Watches the temporary file of a timeline, and one recording at a time."""

    def __init__(self, timeline: Timeline) -> None:
        self._timeline = timeline
        self._warned_of_temporary = False
        self._recording: Path | None = None
        self._next_report = 0
        self._next_check = 0
        self._warned_of_disk = False

    def news(self, recording: Path | None, size: int) -> str | None:
        """Return a new warning, None if there is none; ``size`` is in bytes, 0 without a recording."""
        if recording != self._recording:
            self._recording, self._next_report = recording, _LARGE_RECORDING
            self._next_check, self._warned_of_disk = 0, False
        failure = self._timeline.spill_failure
        if failure and not self._warned_of_temporary:
            self._warned_of_temporary = True
            return (
                f"The folder for temporary files, {tempfile.gettempdir()}, takes no more ({failure}): "
                "the run stays in memory from here on; free room there, or name another folder in TMPDIR"
            )
        return None if recording is None else self._of_recording(recording, size)

    def _of_recording(self, recording: Path, size: int) -> str | None:
        if size >= self._next_report:
            self._next_report = 2 * size
            return f"The recording {recording.name} has {_megabytes(size)} by now, and goes on"
        if size >= self._next_check and not self._warned_of_disk:
            self._next_check = size + _CHECK_INTERVAL
            try:
                disk = shutil.disk_usage(recording.absolute().parent)
            except OSError:
                return None
            if disk.free < min(_LOW_SPACE, _LOW_SHARE * disk.total):
                self._warned_of_disk = True
                return (
                    f"The disk has {_megabytes(disk.free)} left for the recording {recording.name}, "
                    "which ends when it is full; free some room, or end the recording"
                )
        return None


def _megabytes(size: int) -> str:
    return f"{size / 1e6:,.0f} MB"
