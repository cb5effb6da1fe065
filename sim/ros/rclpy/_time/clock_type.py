"""``rclpy.clock_type``, as programs import it."""

from sim.ros.time.clock_type import *
