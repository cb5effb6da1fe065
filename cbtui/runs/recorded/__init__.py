"""Recordings: written, summarised, repeated and exported."""
