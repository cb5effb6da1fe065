"""Loggers, their filters, and the format of log lines on a terminal."""
