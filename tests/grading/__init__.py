"""Grading what hostile and honest learners hand in."""
