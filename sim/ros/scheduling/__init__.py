"""Decides which callback runs when: wait set, agenda, callback groups, executors, workers, tasks."""
