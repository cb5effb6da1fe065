"""``rclpy.context``, as programs import it."""

from sim.ros.context.context import *
