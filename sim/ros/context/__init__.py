"""Contexts, ROS arguments and signals: a program's stay on the network."""
