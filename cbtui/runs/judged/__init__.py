"""Runs that are judged: checked, explored and bounded by a budget."""
