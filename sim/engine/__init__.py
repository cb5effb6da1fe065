"""The engine: the process of its own in which one program runs, and what is said to it and by it."""
