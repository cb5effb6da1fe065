"""Lengths of time and counts of things, as numbers and as text."""
