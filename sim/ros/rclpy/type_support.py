"""``rclpy.type_support``, as programs import it."""

from sim.ros.entities.type_support import *
