"""Marks the submissions of many learners, each confined and audited."""
