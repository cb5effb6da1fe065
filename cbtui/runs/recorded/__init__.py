"""Recordings: writing, summaries, repetitions and exports."""
