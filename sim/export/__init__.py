"""Exports a run for other programs: trace viewers, spreadsheets, documents.

``TraceExporter`` (to a ``PerfettoFile`` or ``ChromeFile``) and ``CallTable`` take batches of events, in
constant memory; pictures and reports are made from a timeline.
"""

from sim.export.chrome import ChromeFile
from sim.export.csv import CallTable
from sim.export.markdown import report
from sim.export.perfetto import PerfettoFile
from sim.export.svg import svg
from sim.export.trace_exporter import TraceExporter

__all__ = ["CallTable", "ChromeFile", "TraceExporter", "PerfettoFile", "report", "svg"]
