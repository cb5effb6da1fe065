"""``rclpy.handle``, as programs import it."""

from sim.ros.handle import *
