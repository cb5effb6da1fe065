"""Output and input of programs: streams, terminal and file descriptors."""
