"""``rclpy.exceptions``, as programs import it."""

from sim.ros.exceptions import *
