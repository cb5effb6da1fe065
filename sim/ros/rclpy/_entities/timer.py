"""``rclpy.timer``, as programs import it."""

from sim.ros.entities.timer import *
