"""``rclpy.waitable``, as programs import it."""

from sim.ros.scheduling.waitable import *
