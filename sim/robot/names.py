"""The robot's names: on the network, and of its thread."""

NAMES = ("/odom", "/scan", "/cmd_vel", "/reset_world", "/motor_power")
"""The robot's topics and services."""

THREAD = "robot_driver"
"""The thread that drives it on the model."""
