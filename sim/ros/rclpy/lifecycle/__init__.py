"""``rclpy.lifecycle``, as programs import it."""

from sim.ros.lifecycle import *
