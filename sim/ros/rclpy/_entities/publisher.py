"""``rclpy.publisher``, as programs import it."""

from sim.ros.entities.publisher import *
