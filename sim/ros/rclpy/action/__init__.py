"""``rclpy.action``, as programs import it."""

from sim.ros.actions import *
