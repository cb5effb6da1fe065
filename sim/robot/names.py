"""The robot's names on the network."""

NAMES = ("/odom", "/scan", "/cmd_vel", "/reset_world", "/motor_power")
"""The robot's topics and services."""
