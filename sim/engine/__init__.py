"""The engine: the process in which the programs of a run are executed, and its messages in and out."""
