"""Runs on real rclpy, beside the model: what the probe tells is what happened, and what the model says."""
