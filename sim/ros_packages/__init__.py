"""Packages that nodes import besides rclpy: each folder is what the package of its name gives."""
