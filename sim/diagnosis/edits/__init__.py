"""Edits of a learner's source that cure a finding, at the positions of its syntax tree."""
