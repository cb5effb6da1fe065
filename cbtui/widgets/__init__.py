"""The console's widgets: each draws a timeline at a time, and nothing else."""
