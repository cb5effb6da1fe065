"""rclpy's compiled part, under the name by which rclpy's own modules know it."""

from sim.ros import _rclpy_pybind11 as rclpy_implementation

__all__ = ["rclpy_implementation"]
