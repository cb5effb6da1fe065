"""``rclpy.signals``, as programs import it."""

from sim.ros.context.signals import *
