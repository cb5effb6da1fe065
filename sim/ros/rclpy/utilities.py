"""``rclpy.utilities``, as programs import it."""

from sim.ros.context.utilities import *
