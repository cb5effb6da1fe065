"""The robot: its physics, and the driver node that offers its topics and services."""
