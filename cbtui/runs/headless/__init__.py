"""Runs without the console: log to stderr, summary to stdout."""
