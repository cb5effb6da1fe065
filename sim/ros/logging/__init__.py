"""Loggers, their filters, and how a line looks on a terminal."""
