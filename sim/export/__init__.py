"""Exports a run for other programs: trace viewers, spreadsheets, documents.

``trace_exporter`` (to a file of ``perfetto`` or ``chrome``) and ``csv`` take batches of events, in constant
memory; ``html``, ``markdown`` and ``svg`` are made from a timeline. Nothing is imported here: formats bring
libraries of their own, and most programs need none of them.
"""
