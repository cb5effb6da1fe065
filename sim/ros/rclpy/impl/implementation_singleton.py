"""rclpy's compiled part, under the name by which rclpy's own modules know it."""

from sim.ros.internals import compiled as rclpy_implementation

__all__ = ["rclpy_implementation"]
