"""Whether a trace is whole and can be that of a run: seals, order and counts."""
