"""Runs programs on real rclpy, each in a process of its own, and makes a trace of what their probes tell."""
