"""Who may run, and when: wait set, agenda, callback groups, executors, workers, tasks."""
