"""``rclpy.guard_condition``, as programs import it."""

from sim.ros.entities.guard_condition import *
