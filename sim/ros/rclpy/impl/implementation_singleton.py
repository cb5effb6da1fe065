"""``rclpy.impl.implementation_singleton``, as programs import it."""

from sim.ros.internals import compiled as rclpy_implementation

__all__ = ["rclpy_implementation"]
