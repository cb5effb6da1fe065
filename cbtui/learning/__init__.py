"""Lessons as a learner meets them: pages, predictions, exercises; and the verification of lessons."""
