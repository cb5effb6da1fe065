"""Takes a run to other programs: trace viewers, spreadsheets, paper.

``Narrator`` (into a ``PerfettoFile`` or ``ChromeFile``) and ``CallTable`` take batches of events and need
no more memory for a longer run; a picture and a report are made of a timeline.
"""

from sim.export.chrome import ChromeFile
from sim.export.csv import CallTable
from sim.export.markdown import report
from sim.export.narrator import Narrator
from sim.export.perfetto import PerfettoFile
from sim.export.svg import svg

__all__ = ["CallTable", "ChromeFile", "Narrator", "PerfettoFile", "report", "svg"]
