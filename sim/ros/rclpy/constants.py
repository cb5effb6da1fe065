"""``rclpy.constants``, as programs import it."""

S_TO_NS = 1_000_000_000
"""Nanoseconds in a second."""
