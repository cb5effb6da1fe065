"""Durations, points in time and the types of clocks."""
