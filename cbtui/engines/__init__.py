"""The engine process from outside: its session, process tree, limits, hang detection and control socket."""
