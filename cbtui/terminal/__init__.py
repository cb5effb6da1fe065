"""The terminal and Textual's internals: drivers, signals, streams and the shutdown of the console."""
