"""``rclpy.callback_groups``, as programs import it."""

from sim.ros.scheduling.callback_groups import *
