"""Watchdogs that find programs that wait, hang or spin, and name the line."""
