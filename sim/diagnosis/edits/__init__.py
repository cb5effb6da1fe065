"""Edits of a learner's source that cure what a rule has found, made at the places of its syntax tree."""
