"""``rclpy.type_hash``, as programs import it."""

from sim.ros.middleware.type_hash import *
