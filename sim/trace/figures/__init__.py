"""Figures of a run: statistics, summaries and comparisons."""
