"""What programs print and read: output, terminal and file descriptors."""
