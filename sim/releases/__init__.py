"""Releases of rclpy, and how their behaviour differs."""
