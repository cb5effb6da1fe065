"""Contexts, ROS arguments and signals."""
