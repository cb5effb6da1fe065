"""Where a timeline keeps its rows: the newest in memory, older ones in a temporary file."""
