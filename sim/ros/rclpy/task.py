"""``rclpy.task``, as programs import it."""

from sim.ros.scheduling.task import *
