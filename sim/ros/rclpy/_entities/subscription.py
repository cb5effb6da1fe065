"""``rclpy.subscription``, as programs import it."""

from sim.ros.entities.subscription import *
