"""``rclpy._rclpy_pybind11``, as programs import it."""

from sim.ros.internals.compiled import *
