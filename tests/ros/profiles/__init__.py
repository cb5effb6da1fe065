"""Tests of what differs between releases of rclpy."""
