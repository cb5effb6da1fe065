"""Durations, times and the types of clocks."""
