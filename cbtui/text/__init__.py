"""Text for terminals: cells, durations, escaping, and the output of commands."""
