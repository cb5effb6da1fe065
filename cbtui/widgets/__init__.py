"""The console's widgets: each draws a timeline at a moment, and nothing else."""
