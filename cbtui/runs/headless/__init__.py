"""Headless runs: log to stderr, summary to stdout."""
