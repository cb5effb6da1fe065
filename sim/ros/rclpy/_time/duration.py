"""``rclpy.duration``, as programs import it."""

from sim.ros.time.duration import *
