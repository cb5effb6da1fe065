"""Exports a run on screen to a new file in the current folder, on another thread."""

from dataclasses import dataclass
from pathlib import Path
from threading import Event

from cbtui.runs.live.live_recording import unused_name
from cbtui.runs.recorded.exporting import FORMATS, EventSource, ExportError, ExportRequest, export
from sim.recording import RecordingError
from sim.trace.model import Nanoseconds, Window


class _GivenUpError(Exception):
    """The export was given up."""


@dataclass(frozen=True)
class ExportableRun:
    """A run's title, events and end, and a sentence on missing events."""

    title: str
    batches: EventSource
    end: Nanoseconds
    missing: str = ""


class LiveExport:
    """One file in one of ``FORMATS``; ``window`` is what a picture shows, None for the whole run.

    ``write`` runs on any thread; the other members may be used on another one meanwhile.
    """

    def __init__(self, material: ExportableRun, form: str, window: Window | None) -> None:
        self._material = material
        suffix = Path(FORMATS[form][0]).suffix
        self._path = unused_name(material.title, suffix).absolute()
        start, end = (0, None) if window is None else (window.start / 1e9, window.end / 1e9)
        self._wish = ExportRequest({form: self._path}, start, end, replace=False)
        self._given_up = Event()
        self.share = 0.0
        """The exported share of the run, from 0 to 1."""
        self.over = False
        """Whether ``write`` has returned."""

    def give_up(self) -> None:
        """Abort; leaves no file unless it is complete already."""
        self._given_up.set()

    def write(self) -> str:
        """Write the file; returns a sentence on its path, or on why it could not be written."""
        try:
            export(self._material.batches, self._wish, self._reach)
        except _GivenUpError:
            return f"The export was cancelled, so {self._path.name} was not written"
        except (ExportError, RecordingError) as error:
            return f"Nothing was exported: {error}"
        finally:
            self.over = True
        missing = self._material.missing
        return f"Exported to {self._path}" + (f"; {missing}" if missing else "")

    def _reach(self, moment: Nanoseconds) -> None:
        if self._given_up.is_set():
            raise _GivenUpError
        self.share = min(1.0, moment / max(1, self._material.end))
