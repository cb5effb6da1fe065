"""``rclpy.time``, as programs import it."""

from sim.ros.time.time import *
